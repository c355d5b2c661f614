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
    let expected = [
        ("translation", 0x1ef0_da17_670e_d36e),
        ("sub-pixel", 0x634c_ab86_46f3_1300),
        ("pillar", 0x0cdb_01e3_1202_13ae),
        ("parallax", 0x0fc6_fa92_af3d_63f6),
        ("spin-zoom", 0x06d3_f143_0ae4_aef0),
        ("fast-ball", 0xf7b9_766c_072b_0736),
        ("barber-pole", 0xb830_16dc_44ae_e2b9),
        ("wallpaper", 0xa1b5_fbc7_37be_870e),
        ("flat-wall", 0x4f7c_a619_6576_bb20),
        ("flicker", 0x1f38_14f0_1ba5_9e54),
        ("crossing-stars", 0x17b6_3b83_c4cb_91c8),
        ("formation", 0xe47d_7838_6a03_13e5),
        ("traffic", 0xf5cc_b313_f212_9f00),
        ("hand-held", 0x0664_a860_a20d_89ff),
        ("passing-bus", 0x249f_1029_2c3f_e244),
        ("flag", 0x971d_5ef0_a63e_aeb5),
        ("balloon", 0xe1c6_0a96_e56e_ebc8),
        ("tunnel", 0x0c60_423e_9470_1f73),
        ("leaves", 0x866f_0c9f_afc7_0a01),
        ("rigid-layers", 0xac42_703d_5c9c_1bf6),
        ("turntable", 0xf259_fe60_029a_1b82),
        ("still-life", 0x5935_d7b7_6cb0_174f),
        ("stereo-traps", 0x44b3_1ab7_128c_c20b),
        ("drive", 0xafbc_0124_497d_bd96),
        ("turning-box", 0x119b_f38b_2c97_ba6a),
        ("spinning-sign", 0x5081_800f_c518_d4b2),
        ("blurred-swing", 0xfbb6_19ed_4fac_457d),
        ("fast-flight", 0x2953_8cbb_4011_4d93),
        ("wrong-way", 0x76b0_3540_6160_a0a4),
    ];
    assert_eq!(found, expected, "{found:#018x?}");
}
