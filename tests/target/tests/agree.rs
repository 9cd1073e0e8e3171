//! Agreement of the host's engines.

use inference::kernel::{Native, Portable};
use on_target::agreement::digest;
use on_target::network::Room;

#[test]
fn engines_of_the_host_agree_on_every_shape_and_mode() {
    let mut room = Room([0; 20_000]);
    let mut digests = Vec::new();
    for seed in 1..=20 {
        let portable = digest::<Portable>(seed, &mut room);
        assert!(portable.is_some(), "seed {seed}: parameters");
        assert_eq!(digest::<Native>(seed, &mut room), portable, "seed {seed}");
        digests.push(portable);
    }
    digests.dedup();
    assert_eq!(digests.len(), 20, "different seeds, different digests");
}
