//! What comes back, and what damage is told.

use super::*;
use crate::error::IoError;
use crate::writes::Writes;
use std::io::Read;

fn write(path: &Path, shift: f64) {
    let mut file = CheckpointWriter::create(path, &Writes::default()).unwrap();
    let values = [0.1 + shift, f64::INFINITY, -0.0, 5e-324];
    file.numbers("numbers", 4, &mut values.into_iter()).unwrap();
    file.counts("counts", 2, &mut [7, u64::MAX].into_iter()).unwrap();
    file.bytes("text", 5, &mut "rope!".as_bytes()).unwrap();
    file.counts("none", 0, &mut std::iter::empty()).unwrap();
    // More than one block.
    file.numbers("many", 20_000, &mut (0..20_000).map(f64::from)).unwrap();
    file.commit().unwrap();
}

fn fault(path: &Path) -> CheckpointFault {
    match CheckpointReader::open(path).map(|_| ()) {
        Err(IoError::Checkpoint(error)) => error.fault,
        other => unreachable!("{other:?}"),
    }
}

#[test]
fn bytes_in_memory_read_as_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("c");
    let mut writer = CheckpointWriter::create(&path, &Writes::default()).unwrap();
    writer.numbers("a", 2, &mut [1.5, -0.0].into_iter()).unwrap();
    writer.bytes("text", 2, &mut "xy".as_bytes()).unwrap();
    writer.commit().unwrap();
    let reader = CheckpointReader::of_bytes(&path, std::fs::read(&path).unwrap()).unwrap();
    assert_eq!(reader.numbers("a").unwrap(), [1.5, -0.0]);
    assert_eq!(reader.text("text").unwrap(), "xy");
    let error = CheckpointReader::open(folder.path()).unwrap_err();
    assert!(matches!(error, IoError::Read { .. }), "{error}");
}

#[test]
fn everything_comes_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("checkpoint");
    write(&path, 1.0);
    write(&path, 0.0);
    let file = CheckpointReader::open(&path).unwrap();
    let bits = |v: Vec<f64>| v.into_iter().map(f64::to_bits).collect::<Vec<_>>();
    assert_eq!(bits(file.numbers("numbers").unwrap()), bits(vec![0.1, f64::INFINITY, -0.0, 5e-324]));
    assert_eq!(file.counts("counts").unwrap(), [7, u64::MAX]);
    assert_eq!(file.text("text").unwrap(), "rope!");
    assert!(file.counts("none").unwrap().is_empty());
    let (mut many, mut bytes) = (vec![0.0; 20_000], Vec::new());
    file.read_numbers("many", &mut many).unwrap();
    assert!(many.iter().zip(0..20_000).all(|(a, b)| *a == f64::from(b)));
    file.bytes("text").unwrap().read_to_end(&mut bytes).unwrap();
    assert_eq!(bytes, b"rope!");
    assert!(file.read_numbers("numbers", &mut [0.0; 3]).is_err());
    assert!(file.counts("numbers").is_err() && file.numbers("no such").is_err());
    assert_eq!(CheckpointReader::open(&previous(&path)).unwrap().numbers("numbers").unwrap()[0], 1.1);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);
}

#[test]
fn every_damage_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("checkpoint");
    write(&path, 0.0);
    let whole = std::fs::read(&path).unwrap();
    let lengths = (0..300).chain((300..whole.len()).step_by(997)).chain(whole.len() - 30..whole.len());
    for length in lengths {
        std::fs::write(&path, &whole[..length]).unwrap();
        assert!(matches!(fault(&path), CheckpointFault::Truncated | CheckpointFault::Magic), "{length}");
    }
    let places = (0..300).chain((300..whole.len()).step_by(997)).chain(whole.len() - 30..whole.len());
    for place in places {
        for bit in [0, 3, 7] {
            let mut bytes = whole.clone();
            bytes[place] ^= 1 << bit;
            std::fs::write(&path, &bytes).unwrap();
            fault(&path);
        }
    }
    std::fs::write(&path, [whole.as_slice(), b"!"].concat()).unwrap();
    assert_eq!(fault(&path), CheckpointFault::Trailing { count: 1 });
    std::fs::write(&path, "time [s]\n").unwrap();
    assert_eq!(fault(&path), CheckpointFault::Magic);
    std::fs::remove_file(&path).unwrap();
    assert!(matches!(CheckpointReader::open(&path), Err(IoError::Read { .. })));
}

#[test]
fn a_failing_write_leaves_the_one_before() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("checkpoint");
    write(&path, 0.0);
    for first in 1.. {
        let writes = Writes::failing(first, 1);
        let file = CheckpointWriter::create(&path, &writes).and_then(|mut file| {
            file.numbers("numbers", 20_000, &mut std::iter::repeat_n(2.0, 20_000))?;
            file.commit()
        });
        let kept = [path.clone(), previous(&path)].iter().any(|p| CheckpointReader::open(p).is_ok());
        assert!(kept, "write {first}");
        if file.is_ok() {
            assert!(writes.done() < first);
            break;
        }
    }
    assert_eq!(CheckpointReader::open(&path).unwrap().numbers("numbers").unwrap()[0], 2.0);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);
}
