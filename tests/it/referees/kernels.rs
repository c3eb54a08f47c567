//! Kernels made and read by CSPICE: as `tests/it/spice.rs`, over many more moments.

use std::path::Path;
use std::process::Command;

use super::python_with;
use crate::scratch::{Scratch, is_heavy};
use crate::spice;

#[test]
fn kernels_are_as_cspice_has_them() {
    let Some(python) = python_with("import importlib.util as u, sys; sys.exit(u.find_spec('spiceypy') is None)") else {
        return;
    };
    let scratch = Scratch::new();
    for name in ["probe.tls", "mars.tpc", "probe.tf", "probe.tsc"] {
        scratch.write(name, std::fs::read(spice::data().join(name)).unwrap());
    }
    let count = if is_heavy() { "10000" } else { "1000" };
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/it/referees/kernels.py");
    let made = Command::new(python).arg(script).arg(scratch.path()).arg(count).output().unwrap();
    assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
    spice::compare(scratch.path(), &spice::ALL);
}
