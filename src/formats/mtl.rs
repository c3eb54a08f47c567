//! Materials of OBJ files (`.mtl`): names and diffuse colours. Textures and everything about shine are passed over.

use std::io::{self, Write};
use std::path::Path;

use crate::error::{Location, Problem, Result};
use crate::landscape::MATERIALS;

use super::input::{self, BYTE_ORDER_MARK, InputFile, Problems};

/// A material of an OBJ file.
#[derive(Debug, Clone, PartialEq)]
pub struct ObjMaterial {
    /// Name; empty for faces before the first `usemtl`.
    pub name: String,
    /// Diffuse colour `Kd`, linear RGB 0 to 1, if the material file gives one.
    pub kd: Option<[f64; 3]>,
}

/// The materials of a generated landscape, by their index in its mesh.
pub fn of_landscapes() -> Vec<ObjMaterial> {
    MATERIALS.map(|(name, kd)| ObjMaterial { name: name.to_owned(), kd: Some(kd) }).into()
}

/// The name nearest to this one that a line of an OBJ or MTL file can hold.
pub(crate) fn plain_name(name: &str) -> String {
    let mut name: String = name.trim().chars().map(|c| if c.is_control() { '_' } else { c }).collect();
    // At its end it would join the next line to this one.
    if name.ends_with('\\') {
        name.push('_');
    }
    name
}

/// No material file is this long, bytes.
const LIMIT: u64 = 64 << 20;

/// Reads a material file.
///
/// # Errors
/// [`Error::Io`](crate::Error::Io); [`Error::Invalid`](crate::Error::Invalid) with every line that cannot be used.
pub fn read(path: &Path) -> Result<(Vec<ObjMaterial>, InputFile)> {
    let bytes = input::bytes(path, LIMIT)?;
    Ok((parse(&bytes, path)?, InputFile::of(path, &bytes)))
}

/// Reads the text of a material file; `path` is for messages.
///
/// # Errors
/// [`Error::Invalid`](crate::Error::Invalid) with every line that cannot be used.
pub fn parse(bytes: &[u8], path: &Path) -> Result<Vec<ObjMaterial>> {
    let mut materials: Vec<ObjMaterial> = Vec::new();
    let mut problems = Problems::default();
    let bytes = bytes.strip_prefix(BYTE_ORDER_MARK).unwrap_or(bytes);
    for (i, line) in String::from_utf8_lossy(bytes).lines().enumerate() {
        let mut problem = |message: String| problems.push(|| Problem::new(Location::line(path, i + 1), message));
        let line = line.trim();
        let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        match keyword {
            "newmtl" => materials.push(ObjMaterial { name: rest.trim().to_owned(), kd: None }),
            "Kd" => {
                let words: Vec<&str> = rest.split_whitespace().take_while(|w| !w.starts_with('#')).collect();
                if matches!(words.first(), Some(&"spectral" | &"xyz")) {
                    continue;
                }
                let numbers: Vec<f64> = words.iter().filter_map(|w| w.parse().ok()).collect();
                let kd = match numbers[..] {
                    _ if numbers.len() != words.len() => None,
                    [r] => Some([r, r, r]),
                    [r, g, b] => Some([r, g, b]),
                    _ => None,
                };
                match (kd.filter(|kd| kd.iter().all(|c| (0.0..=1.0).contains(c))), materials.last_mut()) {
                    (Some(kd), Some(material)) => material.kd = Some(kd),
                    (Some(_), None) => problem("`Kd` before the first `newmtl`".into()),
                    (None, _) => problem(format!("`Kd {}` is not three numbers from 0 to 1", rest.trim())),
                }
            }
            _ => {}
        }
    }
    problems.finish(path)?;
    Ok(materials)
}

/// Writes a material file.
///
/// # Errors
/// What the writer says.
pub fn write(out: &mut impl Write, materials: &[ObjMaterial]) -> io::Result<()> {
    for material in materials {
        writeln!(out, "newmtl {}", material.name)?;
        if let Some([r, g, b]) = material.kd {
            writeln!(out, "Kd {r} {g} {b}")?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_colours() {
        let text =
            b"# c\nnewmtl blue unit\r\nKd 0.1 0.2 0.3 # linear\nKs 1 1 1\nnewmtl b\nKd 0.5\nnewmtl c\nmap_Kd x.png\n";
        let materials = parse(text, Path::new("a.mtl")).unwrap();
        let expected = [("blue unit", Some([0.1, 0.2, 0.3])), ("b", Some([0.5; 3])), ("c", None)];
        assert_eq!(materials.len(), 3);
        for (material, (name, kd)) in materials.iter().zip(expected) {
            assert_eq!((material.name.as_str(), material.kd), (name, kd));
        }
        let mut written = Vec::new();
        write(&mut written, &materials).unwrap();
        assert_eq!(parse(&written, Path::new("b.mtl")).unwrap(), materials);
    }

    #[test]
    fn every_bad_line_is_told() {
        let error = parse(b"Kd 1 1 1\nnewmtl a\nKd 1 2\nKd 300 0 0\nKd nan 0 0\n", Path::new("a.mtl")).unwrap_err();
        let told = error.to_string();
        assert_eq!(told.lines().count(), 4, "{told}");
        assert!(told.starts_with("a.mtl:1: `Kd` before"), "{told}");
        assert!(told.contains("a.mtl:4: `Kd 300 0 0` is not"), "{told}");
    }
}
