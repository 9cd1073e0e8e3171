//! The table against itself.

use super::*;

#[test]
fn boards_are_found_by_their_name() {
    for board in &BOARDS {
        assert_eq!(find(board.name), Some(board));
    }
    for unknown in ["stm32f40", "stm32f4055", ""] {
        assert_eq!(find(unknown), None);
    }
    let error = parse("stm32f4").unwrap_err().to_string();
    assert!(error.starts_with("expected one of stm32f405, feather-stm32f405"), "{error}");
}

#[test]
fn only_boards_that_share_the_default_target_have_images_of_their_own_name() {
    let names = ["stm32f405", "netduino-plus-2", "nucleo-h743zi2", "mps2-an505"]
        .map(|name| find(name).unwrap().image_name().to_string());
    assert_eq!(names, ["estimator", "estimator-netduino-plus-2", "estimator-nucleo-h743zi2", "estimator"]);
}

#[test]
fn no_pin_has_two_uses_on_any_board() {
    for board in &BOARDS {
        let Some(signals) = board.microcontroller.signals else { continue };
        for (index, signal) in signals.iter().enumerate() {
            let pin = (signal.port, signal.pin);
            assert!(signals[..index].iter().all(|other| (other.port, other.pin) != pin), "{}", signal.name);
            assert!(board.light.is_none_or(|light| (light.port, light.pin) != pin), "{}", signal.name);
        }
    }
}

#[test]
fn every_memory_map_has_flash_stack_and_ram() {
    for board in &BOARDS {
        let map = board.microcontroller.memory_map;
        let [flash, stack, ram] = ["FLASH", "STACK", "RAM"].map(|name| map.region(name).unwrap());
        assert_eq!(stack.end(), ram.origin, "{}: the stack lies directly below the RAM", board.name);
        assert!(flash.length >= 512 * 1024, "{}", board.name);
    }
    let flash = BOARDS[0].microcontroller.memory_map.region("FLASH").unwrap();
    assert_eq!((flash.origin, flash.length), (0x0800_0000, 512 * 1024));
    assert!(flash.contains(0x0807_FFFF, 1) && !flash.contains(0x0807_FFFF, 2));
}

#[test]
fn flash_sectors_begin_with_the_flash_and_ascend_within_it() {
    for board in BOARDS.iter().filter(|board| !board.microcontroller.is_emulated_only()) {
        let (sectors, map) = (board.microcontroller.flash_sectors, board.microcontroller.memory_map);
        let flash = map.region("FLASH").unwrap();
        assert_eq!(sectors.first(), Some(&flash.origin));
        assert!(sectors.is_sorted() && sectors.iter().all(|&sector| flash.contains(sector.into(), 1)));
    }
}

#[test]
fn model_packages_exist_for_every_microcontroller() {
    for board in &BOARDS {
        let feature = board.microcontroller.feature;
        assert!(model_package::board::ALL.iter().any(|board| board.name == feature), "{feature}");
    }
}
