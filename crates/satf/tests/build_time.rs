#[test]
fn t() {
    let clock = std::time::Instant::now();
    let d = lovelock_satf::Database::build(&|_| ());
    eprintln!("{:?}", clock.elapsed());
    let mut all = Vec::new();
    for r in d.reflectances().chunks(64) { all.extend_from_slice(&r[..32]); }
    for r in d.opacities().chunks(64) { all.extend_from_slice(&r[..32]); }
    let mut delta = all.clone();
    for i in (1..all.len()).rev() { delta[i] = all[i].wrapping_sub(all[i-1]); }
    let mut dl = all.clone();
    for i in (32..all.len()).rev() { dl[i] = all[i].wrapping_sub(all[i-32]); }
    for a in [&all, &delta, &dl] {
    eprintln!("{} -> {}", a.len(), lz4_flex::block::compress(a).len());
    }
    for depth in [0,5,10,15] { eprintln!("{:?}", &d.opacity_record(16+depth, 0)[..64]);
     eprintln!("{:?}", &d.opacity_record(16+depth, 3)[..64]);
     eprintln!("{:?}", &d.reflectance_record(16+depth, 0, 2)[..64]); }
}
