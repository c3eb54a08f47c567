//! Materials of OBJ files (`.mtl`): names and diffuse colours. What else makes a surface look as it does is reported; shine (`Ka`, `Ks`, `Ns`,
//! `Ni`, `illum`, `Pr` ..) is ignored, as every exporter writes some.

use std::io::{self, Write};
use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::error::{Location, Problem, Result};
use crate::landscape::LandscapeMaterial;

use super::input::{self, BYTE_ORDER_MARK, InputFile, Problems};

/// A material of an OBJ file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ObjMaterial {
    /// Name; empty for faces before the first `usemtl`.
    pub name: String,
    /// Diffuse colour `Kd`, linear RGB 0 to 1, if the material file gives one.
    pub kd: Option<[f64; 3]>,
}

/// The materials of a generated landscape, by their index in its mesh.
pub fn of_landscape(materials: &[LandscapeMaterial]) -> Vec<ObjMaterial> {
    materials.iter().map(|m| ObjMaterial { name: m.name.clone(), kd: Some(m.colour) }).collect()
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

/// What a material file holds.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct MtlFile {
    /// Its materials, in its order.
    pub materials: Vec<ObjMaterial>,
    /// What it says beyond names and colours: the material's name, the line (from 1), and what it is.
    pub losses: Vec<(String, usize, &'static str)>,
    /// The first line with a name that is not UTF-8, and is read as Windows-1252.
    pub not_utf8: Option<usize>,
}

/// Reads a material file.
///
/// # Errors
/// [`Error::Io`](crate::Error::Io); [`Error::Invalid`](crate::Error::Invalid) with every line that cannot be used.
pub fn read(path: &Path) -> Result<(MtlFile, InputFile)> {
    let bytes = input::bytes(path, LIMIT)?;
    Ok((parse_all(&bytes, path)?, InputFile::of(path, &bytes)))
}

/// The materials in the text of a material file; `path` is for messages.
///
/// # Errors
/// As [`parse_all`].
pub fn parse(bytes: &[u8], path: &Path) -> Result<Vec<ObjMaterial>> {
    parse_all(bytes, path).map(|file| file.materials)
}

/// Reads the text of a material file; `path` is for messages.
///
/// # Errors
/// [`Error::Invalid`](crate::Error::Invalid) with every line that cannot be used.
pub fn parse_all(bytes: &[u8], path: &Path) -> Result<MtlFile> {
    let mut file = MtlFile::default();
    let mut problems = Problems::default();
    let bytes = bytes.strip_prefix(BYTE_ORDER_MARK).unwrap_or(bytes);
    for (i, line) in bytes.split(|b| *b == b'\n').enumerate() {
        let mut problem = |message: String| problems.push(|| Problem::new(Location::line(path, i + 1), message));
        // Line by line, as an OBJ file's names are read name by name: the same bytes are the same name.
        let (line, is_utf8) = input::decoded(line);
        let line = line.trim();
        let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        match keyword {
            "newmtl" => {
                file.materials.push(ObjMaterial { name: rest.trim().to_owned(), kd: None });
                if !is_utf8 {
                    file.not_utf8.get_or_insert(i + 1);
                }
            }
            "Kd" => {
                let words: Vec<&str> = rest.split_whitespace().take_while(|w| !w.starts_with('#')).collect();
                if matches!(words.first(), Some(&"spectral" | &"xyz")) {
                    file.lose(i + 1, "a colour in another form than three numbers (`Kd spectral`, `Kd xyz`)");
                    continue;
                }
                let numbers: Vec<f64> = words.iter().filter_map(|w| w.parse().ok()).collect();
                let kd = match numbers[..] {
                    _ if numbers.len() != words.len() => None,
                    [r] => Some([r, r, r]),
                    [r, g, b] => Some([r, g, b]),
                    _ => None,
                };
                match (kd.filter(|kd| kd.iter().all(|c| (0.0..=1.0).contains(c))), file.materials.last_mut()) {
                    (Some(kd), Some(material)) => material.kd = Some(kd),
                    (Some(_), None) => problem("`Kd` before the first `newmtl`".into()),
                    (None, _) => problem(format!("`Kd {}` is not three numbers from 0 to 1", rest.trim())),
                }
            }
            _ => {
                if let Some(what) = loss(keyword, rest) {
                    file.lose(i + 1, what);
                }
            }
        }
    }
    problems.finish(path)?;
    Ok(file)
}

impl MtlFile {
    /// Notes what is lost of the material at hand, once.
    fn lose(&mut self, line: usize, what: &'static str) {
        let Some(ObjMaterial { name, .. }) = self.materials.last() else { return };
        let mut of_this = self.losses.iter().rev().take_while(|(of, ..)| of == name);
        if !of_this.any(|(.., told)| *told == what) {
            self.losses.push((name.clone(), line, what));
        }
    }
}

/// What a statement says that has no place in a Lambert surface of one spectrum.
fn loss(keyword: &str, rest: &str) -> Option<&'static str> {
    let numbers = || rest.split_whitespace().filter_map(|word| word.parse::<f64>().ok());
    let any = |is: fn(f64) -> bool, what: &'static str| numbers().any(is).then_some(what);
    let keyword = keyword.to_lowercase();
    match keyword.as_str() {
        "disp" | "map_disp" => Some("a displacement map, which would move the surface"),
        "bump" | "norm" | "refl" | "decal" => Some("textures: a material has one spectrum"),
        _ if keyword.starts_with("map_") => Some("textures: a material has one spectrum"),
        "ke" => any(|e| e != 0.0, "light of its own (`Ke`)"),
        "d" => any(|d| d < 1.0, "transparency: surfaces are opaque"),
        "tr" => any(|t| t > 0.0, "transparency: surfaces are opaque"),
        "tf" => any(|t| t < 1.0, "transparency: surfaces are opaque"),
        "pm" => any(|metallic| metallic > 0.0, "that it is of metal: surfaces are Lambert"),
        _ => None,
    }
}

/// Writes a material file.
///
/// # Errors
/// What the writer says.
pub fn write(out: &mut impl Write, materials: &[ObjMaterial]) -> io::Result<()> {
    for material in materials.iter().filter(|material| !material.name.is_empty()) {
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
