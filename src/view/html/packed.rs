//! Bytes as text: compressed as gzip (RFC 1952), then base64 (RFC 4648). The same bytes give the same text on every machine.

use miniz_oxide::deflate::compress_to_vec;

/// Of 10: more takes much longer and saves little.
const LEVEL: u8 = 8;
const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

/// Compressed and encoded.
pub(crate) fn packed(bytes: &[u8]) -> String {
    base64(&gzip(bytes))
}

/// A gzip file of one member, without name and time.
fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut out = vec![0x1f, 0x8b, 8, 0, 0, 0, 0, 0, 0, 255];
    out.extend(compress_to_vec(bytes, LEVEL));
    out.extend(crc32(bytes).to_le_bytes());
    out.extend((bytes.len() as u32).to_le_bytes());
    out
}

/// The sum that gzip asks for.
fn crc32(bytes: &[u8]) -> u32 {
    let entry =
        |number: u32| (0..8).fold(number, |sum, _| if sum & 1 == 1 { 0xedb8_8320 ^ (sum >> 1) } else { sum >> 1 });
    let table: [u32; 256] = std::array::from_fn(|number| entry(number as u32));
    !bytes.iter().fold(u32::MAX, |sum, &byte| table[(sum as u8 ^ byte) as usize] ^ (sum >> 8))
}

fn base64(bytes: &[u8]) -> String {
    let mut out = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for group in bytes.chunks(3) {
        let at = |index: usize| u32::from(group.get(index).copied().unwrap_or(0));
        let number = at(0) << 16 | at(1) << 8 | at(2);
        for place in 0..4 {
            let letter = LETTERS[(number >> (18 - 6 * place) & 63) as usize] as char;
            out.push(if place > group.len() { '=' } else { letter });
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_that_of_the_standards() {
        // RFC 4648, section 10.
        for (plain, text) in [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foobar", "Zm9vYmFy")] {
            assert_eq!(base64(plain.as_bytes()), text);
        }
        // The check value of CRC-32/ISO-HDLC.
        assert_eq!(crc32(b"123456789"), 0xcbf4_3926);
    }

    #[test]
    fn what_is_compressed_comes_back() {
        let bytes: Vec<u8> = (0..20_000_u32).map(|i| (i * i / 7) as u8).collect();
        let gzip = gzip(&bytes);
        let inner = &gzip[10..gzip.len() - 8];
        assert_eq!(miniz_oxide::inflate::decompress_to_vec(inner).expect("it is whole"), bytes);
    }
}
