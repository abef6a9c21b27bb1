use std::io::Cursor;

use lovelock_testkit::fuzz::damaged;

use crate::{
    Archive, ArchiveWriter, CompoundTree, DataType, Object, ObjectTree, Pod, Samples, Source, Times,
};

const POINT: DataType = DataType::new(Pod::F32, 3);

fn points(sample: u32) -> Vec<[f32; 3]> {
    (0..5).map(|i| [i as f32, 10.0 * sample as f32, 0.25]).collect()
}

fn bytes(points: &[[f32; 3]]) -> Vec<u8> {
    points.as_flattened().iter().flat_map(|v| v.to_le_bytes()).collect()
}

/// `/top/child`, whose points change from sample 2 to sample 3 and whose counts do not.
fn archive() -> Vec<u8> {
    let mut writer = ArchiveWriter::create(Cursor::new(Vec::new())).expect("memory");
    let times = writer.add_times(Times::uniform(0.5, 0.25));
    let mut moved = Samples::array(POINT, times);
    let mut counts = Samples::array(DataType::new(Pod::I32, 1), times);
    for sample in [0, 0, 1, 2, 2] {
        let stored = writer.store(POINT, &bytes(&points(sample))).expect("memory");
        moved.push(stored);
    }
    let stored = writer.store(counts.ty, &[2, 0, 0, 0, 3, 0, 0, 0]).expect("memory");
    counts.push(stored);
    (0..4).for_each(|_| counts.repeat());
    let mut single = Samples::scalar(DataType::new(Pod::U8, 4), 0);
    single.push(writer.store(single.ty, &[1, 0, 0, 9]).expect("memory"));
    let mut inner = CompoundTree::default();
    inner.samples("P", "geoScope=vtx", moved);
    inner.samples("counts", "", counts);
    inner.samples("basis", &"m".repeat(300), single);
    let mut properties = CompoundTree::default();
    properties.compound(".geom", "schema=S", inner);
    let child = ObjectTree {
        name: "chïld".to_owned(),
        metadata: "schema=S".to_owned(),
        properties,
        children: Vec::new(),
    };
    let top = ObjectTree { name: "top".to_owned(), children: vec![child], ..ObjectTree::default() };
    let (out, length) = writer.finish("_ai_Application=test", vec![top]).expect("memory");
    let bytes = out.into_inner();
    assert_eq!(bytes.len() as u64, length);
    bytes
}

fn only_child(archive: &mut Archive<'_>, of: &Object) -> Object {
    let children = archive.children(of).expect("children");
    assert_eq!(children.len(), 1);
    children[0].clone()
}

#[test]
fn what_is_written_is_read() {
    let file = archive();
    let mut archive = Archive::open(Source::Memory(&file)).expect("an archive");
    assert_eq!(archive.metadata(), "_ai_Application=test");
    let top = archive.top();
    let parent = only_child(&mut archive, &top);
    let child = only_child(&mut archive, &parent);
    assert_eq!((parent.name.as_str(), child.name.as_str()), ("top", "chïld"));
    assert!(child.has_schema("S") && !parent.has_schema("S"));
    assert_eq!(archive.children(&child).expect("none").len(), 0);
    let properties = archive.properties(&child).expect("properties");
    let inner = archive.compound(properties.get(".geom").expect("a compound")).expect("properties");
    assert_eq!(inner.iter().map(|p| p.name.as_str()).collect::<Vec<_>>(), ["P", "counts", "basis"]);
    let moved = inner.get("P").expect("points").clone();
    assert_eq!((moved.samples, moved.metadata.as_str(), moved.ty), (5, "geoScope=vtx", POINT));
    for (sample, wanted) in [0, 0, 1, 2, 2].into_iter().enumerate() {
        let mut read = Vec::new();
        archive.vectors::<3>(&moved, sample as u64, &mut |p| read.push(p)).expect("a sample");
        assert_eq!(read, points(wanted), "sample {sample}");
    }
    assert_eq!(archive.times(&moved).secs(3), 1.25);
    assert!(archive.few(&moved, 5, 100).is_err(), "there is no sixth sample");
    let counts = inner.get("counts").expect("counts");
    assert!(counts.is_constant() && counts.samples == 5);
    assert_eq!(archive.few(counts, 4, 2).expect("counts"), [2.0, 3.0]);
    assert!(archive.few(counts, 4, 1).is_err());
    let basis = inner.get("basis").expect("a scalar");
    assert_eq!(archive.few(basis, 0, 4).expect("numbers"), [1.0, 0.0, 0.0, 9.0]);
    assert_eq!(basis.metadata.len(), 300);
}

/// Reads all that an archive holds. Returns how many numbers that was.
fn read_all(file: &[u8]) -> Result<u64, crate::AlembicError> {
    let mut archive = Archive::open(Source::Memory(file))?;
    let mut objects = vec![archive.top()];
    let mut numbers = 0;
    while let Some(object) = objects.pop() {
        let mut compounds = vec![archive.properties(&object)?];
        while let Some(compound) = compounds.pop() {
            for property in compound.iter() {
                compounds.push(archive.compound(property)?);
                for sample in 0..property.samples.min(8) {
                    archive.numbers(property, sample, &mut |block| numbers += block.len() as u64)?;
                }
            }
        }
        objects.extend(archive.children(&object)?);
    }
    Ok(numbers)
}

#[test]
fn archives_that_are_cut_are_refused() {
    let whole = archive();
    assert!(read_all(&whole).is_ok());
    for length in 0..whole.len() - 8 {
        assert!(read_all(&whole[..length]).is_err(), "{length} bytes of it");
    }
}

#[test]
fn damaged_alembic() {
    let whole = archive();
    let all = read_all(&whole).expect("an archive");
    let counts = damaged("ogawa", &[whole], 3000, |bytes| match read_all(bytes) {
        Ok(numbers) => {
            assert!(
                numbers <= 40 * all.max(bytes.len() as u64),
                "{numbers} numbers of {} bytes",
                bytes.len()
            );
            true
        }
        Err(error) => {
            assert_eq!(error.to_string().lines().count(), 1, "{error}");
            false
        }
    });
    // Measured: 14 % of 33.6 million.
    counts.assert_mixed(0.02);
}

#[test]
fn objects_that_contain_each_other_are_refused() {
    let mut file = archive();
    // The group of `top` becomes its own child: [properties, child, headers].
    let mut groups = Vec::new();
    for at in 16..file.len() - 32 {
        let number = |from: usize| u64::from_le_bytes(file[from..from + 8].try_into().expect("eight"));
        let is_group = number(at) == 3 && number(at + 8) == 0 && number(at + 16) < at as u64;
        if is_group && number(at + 24) >> 63 == 1 {
            groups.push(at);
        }
    }
    let at = *groups.first().expect("the group of an object with one child");
    file[at + 16..at + 24].copy_from_slice(&(at as u64).to_le_bytes());
    let error = read_all(&file).expect_err("a circle").to_string();
    assert!(error.contains("contain each other"), "{error}");
}

#[test]
fn other_files_are_refused_by_name() {
    let refused = |bytes: &[u8], wanted: &str| {
        let error = Archive::open(Source::Memory(bytes)).expect_err(wanted).to_string();
        assert!(error.contains(wanted), "{error}");
    };
    refused(b"\x89HDF\r\n\x1a\n", "HDF5");
    refused(b"", "`Ogawa`");
    refused(b"Ogawa", "`Ogawa`");
    refused(b"OgawaOgawaOgawa!", "not finished");
    refused(b"Ogawa\xff\x00\x02\0\0\0\0\0\0\0\0", "version 2");
    refused(b"Ogawa\xff\x00\x01\0\0\0\0\0\0\0\0", "a group of 0 children");
}
