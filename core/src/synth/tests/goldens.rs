//! The same bytes on every platform and in every version, unless someone means to change them.

use super::*;

/// FNV-1a over the colours of frame 3 in 64×48 with every difficulty on.
fn fingerprint(scene: &Sample) -> u64 {
    let d = Difficulty {
        speed: 1.5,
        scale_change: 1.0,
        rotation: 2.0,
        low_texture: 10.0,
        repeating_texture: 10.0,
        gain: 2.0,
        offset: 1.0,
        flicker: 5.0,
        motion_blur: 40.0,
        noise: 3.0,
        salt_and_pepper: 1.0,
        compression: 20,
        width: 64,
        height: 48,
        ..Difficulty::default()
    };
    let frame = scene.clip(&d).unwrap().frame(3).unwrap();
    let bytes = frame.color().unwrap().cells().as_flattened();
    bytes.iter().fold(0xCBF2_9CE4_8422_2325, |hash, &byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01B3))
}

#[test]
fn every_scene_looks_as_it_did() {
    let found: Vec<_> = SCENES.iter().map(|scene| (scene.id, fingerprint(scene))).collect();
    let expected: [(&str, u64); 0] = [];
    assert_eq!(found, expected, "{found:#018x?}");
}
