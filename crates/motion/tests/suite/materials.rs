//! Materials, textures and images of glTF and VRM.

use crate::common::{self, textured};

use glam::{Vec2, Vec3};
use image::ImageFormat;
use lovelock_base::clock::Stopwatch;
use lovelock_motion::{
    Alpha, Character, Material, Region, Shading, Wrap, load_character, load_character_bytes,
};
use lovelock_testkit::fuzz::damaged;
use textured::{Parts, picture};

fn read(parts: &Parts) -> Character {
    load_character_bytes("x.glb", &textured::glb(parts), None).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn all_of_a_material_is_read() {
    let character = read(&Parts::default());
    assert!(character.notes.is_empty() && character.dropped.is_empty(), "{:?}", character.notes);
    let (body, mesh) = (&character.body, &character.body.mesh);
    assert_eq!(mesh.materials, [0, 1]);
    let [face, other] = &body.materials[..] else { panic!("{:?}", body.materials) };
    let base = face.base.unwrap();
    assert_eq!((base.image, base.set, base.wrap, base.is_nearest), (0, 1, [Wrap::Mirror, Wrap::Clamp], true));
    assert_eq!(base.transform.transform_point2(Vec2::new(0.25, 1.0)), Vec2::new(1.0, 1.0));
    let (normal, slope) = face.normal.unwrap();
    assert_eq!((normal.image, normal.set, normal.wrap, slope), (1, 0, [Wrap::Repeat; 2], 0.5));
    assert_eq!((face.emissive, face.emissive_texture.map(|of| of.image)), (Vec3::X, Some(0)));
    assert_eq!((face.alpha, face.is_double_sided, face.roughness), (Alpha::Mask(0.25), true, 0.25));
    assert_eq!((face.region, face.shading), (Region::Skin, Shading::Lit));
    assert_eq!(face.roughness_texture.map(|of| of.image), Some(1));
    assert_eq!((other.region, other.shading, other.alpha), (Region::Cloth, Shading::Unlit, Alpha::Blend));
    // Factor times vertex colour; the second triangle has neither.
    assert_eq!(
        mesh.colors[..4],
        [Vec3::new(0.5, 1.0, 1.0), Vec3::new(0.25, 0.5, 0.5), Vec3::new(0.5, 1.0, 1.0), Vec3::ONE]
    );
    assert_eq!(mesh.opacity, [0.5, 0.25, 0.0, 1.0, 1.0, 1.0]);
    assert_eq!(mesh.occlusion, [1.0, 0.5, 0.25, 1.0, 1.0, 1.0]);
    assert_eq!(
        mesh.coordinates[0][..3],
        [Vec2::new(0.0, 0.125), Vec2::new(0.25, 0.375), Vec2::new(0.5, 0.625)]
    );
    assert_eq!(mesh.coordinates[1].len(), 6);
    // The stated types of the images are wrong, their bytes are right.
    assert_eq!(body.images.iter().map(|image| image.size).collect::<Vec<_>>(), [[4, 4]; 2]);
    assert_eq!(body.images[0].name, "picture 0");
    assert_eq!(body.images[0].pixels[..8], [250, 0, 30, 255, 250, 0, 30, 245]);
}

#[test]
fn textures_of_metal_and_occlusion_and_far_coordinates_are_told() {
    let materials = r#"[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0,"texCoord":2},"metallicRoughnessTexture":{"index":1}},
        "occlusionTexture":{"index":1}},{}]"#;
    let character = read(&Parts { materials: materials.to_owned(), ..Parts::default() });
    for words in ["1 material has textures of metal", "1 material has textures of occlusion", "second set"] {
        assert!(character.notes.iter().any(|note| note.contains(words)), "{words}: {:?}", character.notes);
    }
    assert!(character.body.materials[0].base.is_none());
}

#[test]
fn a_mask_above_1_hides_its_material() {
    for (stated, cutoff) in [("1.5", 1.5), ("-1", 0.0), ("1e39", 0.5), ("\"x\"", 0.5)] {
        let materials = format!(r#"[{{"alphaMode":"MASK","alphaCutoff":{stated}}},{{}}]"#);
        let body = read(&Parts { materials, ..Parts::default() }).body;
        assert_eq!(body.materials[0].alpha, Alpha::Mask(cutoff), "{stated}");
    }
}

#[test]
fn a_transform_too_large_to_compute_with_is_left_out_and_told() {
    let read_with = |scale: &str| {
        let materials =
            Parts::default().materials.replace(r#""scale":[2,1]"#, &format!(r#""scale":{scale}"#));
        let character = read(&Parts { materials, ..Parts::default() });
        let base = character.body.materials[0].base.unwrap();
        (base.transform.transform_point2(Vec2::new(0.25, 1.0)), character.notes)
    };
    for scale in ["[1e30,1]", "[1,-20000]"] {
        let (place, notes) = read_with(scale);
        assert_eq!(place, Vec2::new(0.25, 1.0), "{scale}");
        assert!(notes.len() == 1 && notes[0].contains("transform"), "{scale}: {notes:?}");
    }
    let (place, notes) = read_with("[1000,1]");
    assert!(place == Vec2::new(250.5, 1.0) && notes.is_empty(), "the control: {place} {notes:?}");
}

#[test]
fn a_figure_of_colours_alone_has_the_default_material() {
    let materials = r#"[{"name":"matt","pbrMetallicRoughness":{"roughnessFactor":0.75,"baseColorFactor":[1,0,0,0.5]}},{}]"#;
    let parts = Parts { materials: materials.to_owned(), ..Parts::default() };
    let body = read(&parts).body;
    assert!(body.materials.is_empty() && body.images.is_empty() && body.mesh.materials.is_empty());
    assert!(body.mesh.opacity.is_empty(), "an opaque material has no opacity");
    assert_eq!(body.mesh.colors[0], Vec3::X);
}

#[test]
fn lost_images_and_wrong_coordinates_are_told() {
    let nan_and_far = [f32::NAN, 0.0, 0.5, 1e30, 0.25, 0.75, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    let parts = Parts {
        images: vec![picture(ImageFormat::Png)[..50].to_vec(), b"no image".to_vec()],
        coordinates: nan_and_far,
        ..Parts::default()
    };
    let character = read(&parts);
    assert_eq!(character.dropped.get("texture_coordinates"), Some(&2));
    assert_eq!(character.body.mesh.coordinates[0][..3], [Vec2::ZERO, Vec2::ZERO, Vec2::new(0.25, 0.75)]);
    assert_eq!(character.notes.len(), 2, "{:?}", character.notes);
    assert!(character.notes[0].contains("picture 0") && character.notes[1].contains("picture 1"));
    assert!(character.body.materials[0].base.is_none() && character.body.images.is_empty());
}

#[test]
fn images_outside_of_the_folder_are_not_read() {
    let folder = tempfile::tempdir().unwrap();
    let inner = folder.path().join("inner");
    std::fs::create_dir(&inner).unwrap();
    std::fs::write(folder.path().join("a.png"), picture(ImageFormat::Png)).unwrap();
    std::fs::write(inner.join("b c.png"), picture(ImageFormat::Png)).unwrap();
    let glb = textured::glb(&Parts { images: Vec::new(), ..Parts::default() });
    let text = String::from_utf8_lossy(&glb[20..]).into_owned();
    let json = &text[..text.find("\"buffers\":").unwrap()];
    // The document without its buffer: positions that have no bytes are zero.
    let json = json
        .replace(r#""bufferView":0,"#, "")
        .replace(r#""images":[]"#, r#""images":[{"uri":"../a.png"},{"uri":"b%20c.png"}]"#);
    let json = format!("{}}}", json.trim_end_matches(','));
    let character = load_character_bytes("x.gltf", json.as_bytes(), Some(&inner)).unwrap();
    assert_eq!(character.notes.len(), 1, "{:?}", character.notes);
    assert!(character.notes[0].contains("only files in its own folder"), "{:?}", character.notes);
    assert_eq!(character.body.images[0].name, "b%20c.png");
    assert!(character.body.materials[0].base.is_none() && character.body.materials[0].normal.is_some());
}

#[test]
fn drawn_materials_of_both_versions_of_vrm_are_the_same() {
    let one = r#"[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}},"alphaMode":"BLEND","extensions":{"KHR_materials_unlit":{},
        "VRMC_materials_mtoon":{"shadeColorFactor":[0.5,0.25,0],"shadeMultiplyTexture":{"index":1},"shadingShiftFactor":-0.05,
        "shadingToonyFactor":0.95,"outlineWidthMode":"worldCoordinates","outlineWidthFactor":0.01,
        "parametricRimColorFactor":[0.25,0.5,0],"parametricRimFresnelPowerFactor":3,"parametricRimLiftFactor":0.1,"rimLightingMixFactor":0.5,
        "matcapTexture":{"index":0}}}},{}]"#;
    // 188 and 137 of 255 are 0.5 and 0.25 in linear light. The ramp from 0 to 0.1.
    let zero = r#","extensions":{"VRM":{"materialProperties":[{"shader":"VRM/MToon","floatProperties":{"_BlendMode":2,"_ShadeShift":0,
        "_ShadeToony":0.9,"_OutlineWidthMode":1,"_OutlineWidth":0.1,"_RimFresnelPower":3,"_RimLift":0.1,
        "_RimLightingMix":0.5},"vectorProperties":{"_Color":[1,1,1,1],
        "_ShadeColor":[0.7353569,0.5370987,0,1],"_RimColor":[0.5370987,0.7353569,0,1],"_MainTex":[0,0,1,1]},"textureProperties":{"_MainTex":0,"_ShadeTexture":1,"_SphereAdd":0}}]}}"#;
    let new = read(&Parts { materials: one.to_owned(), ..Parts::default() });
    let old = read(&Parts { materials: "[{},{}]".to_owned(), more: zero.to_owned(), ..Parts::default() });
    for character in [&new, &old] {
        let material = &character.body.materials[0];
        let Shading::Toon(toon) = material.shading else { panic!("{material:?}") };
        assert!(toon.shade.distance(Vec3::new(0.5, 0.25, 0.0)) < 1e-4, "{toon:?}");
        assert!((toon.shift + 0.05).abs() < 1e-5 && (toon.toony - 0.95).abs() < 1e-5, "{toon:?}");
        assert!(toon.rim.color.distance(Vec3::new(0.25, 0.5, 0.0)) < 1e-4, "{toon:?}");
        assert_eq!((toon.rim.power, toon.rim.lift, toon.rim.lit), (3.0, 0.1, 0.5));
        assert!(character.notes.iter().any(|note| note.contains("reflections")), "{:?}", character.notes);
        let images = (material.base.map(|of| of.image), toon.shade_texture.map(|of| of.image));
        assert_eq!((images, material.alpha), ((Some(0), Some(1)), Alpha::Blend));
        assert!(character.notes.iter().any(|note| note.contains("outlines")), "{:?}", character.notes);
    }
}

#[test]
fn real_figures_have_their_textures() {
    let Some(data) = common::data_dir() else { return };
    for (file, materials, images) in [
        ("CesiumMan.glb", 1, vec![[1024, 1024]]),
        ("CesiumMan_quantized.glb", 1, vec![[1024, 1024]]),
        ("Fox.glb", 1, vec![[1024, 1024]]),
        ("robot.glb", 0, vec![]),
        ("mh_body.glb", 0, vec![]),
    ] {
        let watch = Stopwatch::start();
        let character = load_character(&data.join("characters").join(file)).unwrap();
        println!("{file}: {:.1} ms", watch.ms());
        let body = &character.body;
        assert!(!character.notes.iter().any(|note| note.contains("image")), "{file}: {:?}", character.notes);
        assert_eq!(body.materials.len(), materials, "{file}");
        assert_eq!(body.images.iter().map(|image| image.size).collect::<Vec<_>>(), images, "{file}");
        if materials > 0 {
            assert_eq!(body.mesh.materials.len(), body.mesh.triangles.len(), "{file}");
            let within = |at: &Vec2| at.min_element() > -0.01 && at.max_element() < 1.01;
            let base = body.materials[0].base.unwrap();
            assert!(
                body.mesh.coordinates[0].iter().all(|at| within(&base.transform.transform_point2(*at))),
                "{file}"
            );
        }
    }
}

/// What every character guarantees of its materials.
fn check(character: &Character) {
    let (body, mesh) = (&character.body, &character.body.mesh);
    let (vertices, triangles) = (mesh.positions.len(), mesh.triangles.len());
    let fits = |length: usize, all: usize| length == 0 || length == all;
    assert!(fits(mesh.materials.len(), triangles) && fits(mesh.opacity.len(), vertices));
    assert!(
        mesh.coordinates.iter().all(|set| fits(set.len(), vertices) && set.iter().all(|at| at.is_finite()))
    );
    assert!(mesh.materials.iter().all(|&material| usize::from(material) < body.materials.len()));
    assert!(mesh.colors.iter().all(|color| color.is_finite()));
    for image in body.images.iter() {
        assert_eq!(image.pixels.len() as u64, 4 * u64::from(image.size[0]) * u64::from(image.size[1]));
        assert!(!image.pixels.is_empty());
    }
    for material in &body.materials {
        let Material {
            base, normal, emissive, emissive_texture, roughness_texture, shading, roughness, ..
        } = material;
        let shade = match shading {
            Shading::Toon(toon) => toon.shade_texture,
            Shading::Lit | Shading::Unlit => None,
        };
        let normal = normal.map(|(of, _)| of);
        for texture in [*base, normal, *emissive_texture, *roughness_texture, shade].into_iter().flatten() {
            assert!(texture.image < body.images.len() && texture.set < 2 && texture.transform.is_finite());
        }
        assert!(emissive.is_finite() && (0.0..=1.0).contains(roughness));
    }
}

#[test]
fn damaged_character_materials() {
    let toon = r#"[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}},"extensions":{
        "VRMC_materials_mtoon":{"shadeColorFactor":[0.5,0.25,0],"shadeMultiplyTexture":{"index":1},"shadingShiftFactor":-0.05}}},{}]"#;
    let webp = vec![picture(ImageFormat::WebP), picture(ImageFormat::Jpeg)];
    let sound = [
        textured::glb(&Parts::default()),
        textured::glb(&Parts { materials: toon.to_owned(), images: webp, ..Parts::default() }),
    ];
    damaged("materials", &sound, 3000, |bytes| {
        if let Ok(character) = load_character_bytes("a.glb", bytes, None) {
            check(&character);
        }
        common::reads_character("a.glb", bytes)
    });
}
