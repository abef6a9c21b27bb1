//! How much memory values take.

/// The bytes that a list has reserved, without what its items point to.
pub fn list_bytes<T>(list: &Vec<T>) -> u64 {
    (list.capacity() * size_of::<T>()) as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_list_takes_what_it_has_reserved() {
        assert_eq!(list_bytes(&Vec::<u64>::new()), 0);
        assert!(list_bytes(&Vec::<u64>::with_capacity(10)) >= 80);
    }
}
