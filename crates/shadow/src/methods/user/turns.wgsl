// Limits the turns of the loops of a user's method. A call of `turns_are_over` stands at the start of each of its loops.

// Turns of all loops together in one call of a function of the method. Twin of `MAX_TURNS` in turns.rs.
const MAX_TURNS: u32 = 32768u;
// After so many turns a thread looks whether another one has failed.
const TURNS_BETWEEN_LOOKS: u32 = 256u;

// 0, or what failed: the version of the method in the upper bits, and the number of the loop from 1 in the lower 8.
@group(0) @binding(6) var<storage, read_write> fault: array<atomic<u32>>;

var<private> turns: u32 = 0u;

// Whether the loop of that number must end.
fn turns_are_over(number: u32) -> bool {
    if (turns % TURNS_BETWEEN_LOOKS == 0u && atomicLoad(&fault[0]) != 0u) {
        turns = MAX_TURNS;
    }
    if (turns < MAX_TURNS) {
        turns += 1u;
        return false;
    }
    if (atomicLoad(&fault[0]) == 0u) {
        atomicMax(&fault[0], texels.seeds | number);
    }
    return true;
}
