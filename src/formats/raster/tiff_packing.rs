//! How strips and tiles of TIFF are packed, and what was subtracted from their numbers before.

use std::io::Read;

use crate::formats::number::DataType;

/// What the bytes are packed by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Packing {
    None,
    Lzw,
    Deflate,
    PackBits,
}

impl Packing {
    /// By the tag Compression.
    ///
    /// # Errors
    /// What it is called.
    pub(super) fn of(compression: u64) -> std::result::Result<Self, String> {
        Ok(match compression {
            1 => Packing::None,
            5 => Packing::Lzw,
            8 | 32946 => Packing::Deflate,
            32773 => Packing::PackBits,
            2..=4 => return Err("fax".into()),
            6 | 7 => return Err("JPEG".into()),
            34712 => return Err("JPEG 2000".into()),
            34887 => return Err("LERC".into()),
            34925 => return Err("LZMA".into()),
            50000 => return Err("Zstandard".into()),
            50001 => return Err("WebP".into()),
            50002 => return Err("JPEG XL".into()),
            other => return Err(format!("the method {other}")),
        })
    }

    /// The bytes, as many as are wanted.
    ///
    /// # Errors
    /// That there are fewer, or what is wrong with them.
    pub(super) fn unpacked(self, packed: Vec<u8>, wanted: usize) -> std::result::Result<Vec<u8>, String> {
        let mut bytes = match self {
            Packing::None => packed,
            Packing::Deflate => {
                let mut bytes = room(wanted)?;
                let mut reader = flate2::read::ZlibDecoder::new(packed.as_slice()).take(wanted as u64);
                reader.read_to_end(&mut bytes).map_err(|e| e.to_string())?;
                bytes
            }
            Packing::Lzw => {
                let mut bytes = room(wanted)?;
                bytes.resize(wanted, 0);
                let mut decoder = weezl::decode::Decoder::with_tiff_size_switch(weezl::BitOrder::Msb, 8);
                let (mut read, mut written) = (0, 0);
                while written < wanted {
                    let step = decoder.decode_bytes(&packed[read..], &mut bytes[written..]);
                    (read, written) = (read + step.consumed_in, written + step.consumed_out);
                    match step.status {
                        Ok(weezl::LzwStatus::Ok) if step.consumed_in + step.consumed_out > 0 => {}
                        Ok(_) => break,
                        Err(e) => return Err(e.to_string()),
                    }
                }
                bytes.truncate(written);
                bytes
            }
            Packing::PackBits => pack_bits(&packed, wanted)?,
        };
        if bytes.len() < wanted {
            return Err(format!("{} bytes where {wanted} belong", bytes.len()));
        }
        bytes.truncate(wanted);
        Ok(bytes)
    }
}

fn room(wanted: usize) -> std::result::Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    bytes.try_reserve_exact(wanted).map_err(|e| e.to_string())?;
    Ok(bytes)
}

/// TIFF 6.0, section 9: n from 0 to 127 is followed by n + 1 bytes, n from 129 to 255 by one that is repeated 257 - n times.
fn pack_bits(packed: &[u8], wanted: usize) -> std::result::Result<Vec<u8>, String> {
    let mut bytes = room(wanted)?;
    let mut rest = packed;
    while let Some((n, behind)) = rest.split_first().filter(|_| bytes.len() < wanted) {
        let n = usize::from(*n);
        let taken = match n {
            0..=127 => {
                let some = behind.get(..n + 1).ok_or("it is cut short")?;
                bytes.extend_from_slice(some);
                n + 1
            }
            128 => 0,
            _ => {
                let byte = behind.first().ok_or("it is cut short")?;
                bytes.extend(std::iter::repeat_n(*byte, 257 - n));
                1
            }
        };
        rest = &behind[taken..];
    }
    Ok(bytes)
}

/// What stands for a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Predictor {
    /// The number itself.
    None,
    /// By how much it is more than the one before it in its line, of the same band.
    Horizontal,
    /// The same of bytes, after the bytes of a line were sorted: all first ones, all second ones.
    Real,
}

impl Predictor {
    /// By the tag Predictor.
    pub(super) fn of(tag: u64, data_type: DataType) -> Option<Self> {
        match tag {
            1 => Some(Predictor::None),
            2 => Some(Predictor::Horizontal),
            3 if !data_type.is_integer() => Some(Predictor::Real),
            _ => None,
        }
    }

    /// Makes the bytes of lines of so many numbers those of the numbers; whether their first byte counts most then.
    pub(super) fn undo(
        self,
        bytes: &mut [u8],
        line: usize,
        samples: usize,
        data_type: DataType,
        big_endian: bool,
    ) -> bool {
        let size = data_type.bytes();
        match self {
            Predictor::None => big_endian,
            Predictor::Horizontal => {
                for line in bytes.chunks_exact_mut((line * size).max(1)) {
                    for i in (samples * size..line.len()).step_by(size) {
                        let before = i - samples * size;
                        let mut carry = 0;
                        // From the byte that counts least to the one that counts most.
                        for k in 0..size {
                            let k = if big_endian { size - 1 - k } else { k };
                            let sum = u16::from(line[i + k]) + u16::from(line[before + k]) + carry;
                            line[i + k] = sum.to_le_bytes()[0];
                            carry = sum >> 8;
                        }
                    }
                }
                big_endian
            }
            Predictor::Real => {
                let mut sorted = Vec::new();
                for bytes in bytes.chunks_exact_mut((line * size).max(1)) {
                    for i in samples..bytes.len() {
                        bytes[i] = bytes[i].wrapping_add(bytes[i - samples]);
                    }
                    sorted.clear();
                    sorted.extend_from_slice(bytes);
                    for (i, number) in bytes.chunks_exact_mut(size).enumerate() {
                        number.iter_mut().enumerate().for_each(|(k, byte)| *byte = sorted[k * line + i]);
                    }
                }
                true
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_example_of_the_specification() {
        // TIFF 6.0, section 9.
        let packed = [0xfe, 0xaa, 0x02, 0x80, 0x00, 0x2a, 0xfd, 0xaa, 0x03, 0x80, 0x00, 0x2a, 0x22, 0xf7, 0xaa];
        let bytes = Packing::PackBits.unpacked(packed.to_vec(), 24).unwrap();
        let expected: Vec<u8> =
            [&[0xaa, 0xaa, 0xaa, 0x80, 0x00, 0x2a, 0xaa, 0xaa, 0xaa, 0xaa, 0x80, 0x00, 0x2a, 0x22][..], &[0xaa; 10]]
                .concat();
        assert_eq!(bytes, expected);
        assert!(Packing::PackBits.unpacked(packed[..8].to_vec(), 24).is_err());
        assert_eq!(Packing::None.unpacked(vec![1, 2], 3).unwrap_err(), "2 bytes where 3 belong");
    }

    #[test]
    fn differences_are_summed_up_with_their_carries() {
        // 250, then + 10 and - 1, of two bands each; little and big end first.
        let mut bytes: Vec<u8> = [250_u16, 1, 10, 1, 0xffff, 1].iter().flat_map(|n| n.to_le_bytes()).collect();
        assert!(!Predictor::Horizontal.undo(&mut bytes, 6, 2, DataType::U16, false));
        let expected = [250_u16, 1, 260, 2, 259, 3];
        assert_eq!(bytes, expected.iter().flat_map(|n| n.to_le_bytes()).collect::<Vec<u8>>());
        let mut bytes: Vec<u8> = [250_u16, 1, 10, 1, 0xffff, 1].iter().flat_map(|n| n.to_be_bytes()).collect();
        assert!(Predictor::Horizontal.undo(&mut bytes, 6, 2, DataType::U16, true));
        assert_eq!(bytes, expected.iter().flat_map(|n| n.to_be_bytes()).collect::<Vec<u8>>());
    }
}
