//! Percent-encoding of the parts of a link.

/// The letters that are written as they are: those that neither separate the parts of a link nor end it in the text of a message.
const PLAIN: &str = "-._~:/,@";

/// Returns `text` with all letters encoded that have a meaning in a link, but for those of `also`.
pub(super) fn encode(text: &str, also: &str) -> String {
    let mut encoded = String::new();
    for letter in text.chars() {
        if letter.is_ascii_alphanumeric() || PLAIN.contains(letter) || also.contains(letter) {
            encoded.push(letter);
        } else {
            let mut bytes = [0; 4];
            letter.encode_utf8(&mut bytes).bytes().for_each(|byte| encoded += &format!("%{byte:02X}"));
        }
    }
    encoded
}

/// Returns the text that was encoded.
pub(super) fn decode(encoded: &str) -> String {
    String::from_utf8_lossy(&decoded_bytes(encoded)).into_owned()
}

/// Returns the bytes that were encoded; a `%` without two digits stands for itself.
pub fn decoded_bytes(encoded: &str) -> Vec<u8> {
    let (mut bytes, mut rest) = (Vec::new(), encoded.as_bytes());
    while let Some((&first, after)) = rest.split_first() {
        let digits = after.get(..2).and_then(|digits| std::str::from_utf8(digits).ok());
        let is_code = |digits: &&str| digits.bytes().all(|digit| digit.is_ascii_hexdigit());
        let code = digits.filter(|digits| first == b'%' && is_code(digits));
        let code = code.and_then(|digits| u8::from_str_radix(digits, 16).ok());
        bytes.push(code.unwrap_or(first));
        rest = if code.is_some() { &after[2..] } else { after };
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_text_comes_back() {
        for text in ["pillar,noise=5", "Straße & 100 %.mp4", "a+b#c?d=e|f", "50%25", "", "日本.png"] {
            assert_eq!(decode(&encode(text, "")), text);
            assert!(!encode(text, "").contains(['&', '=', '#', ' ', '+', '|']));
        }
        assert_eq!(encode("synth:pillar,noise=5", "="), "synth:pillar,noise=5");
        for (odd, read) in [("100%", "100%"), ("%zz", "%zz"), ("%+1", "%+1"), ("%c3%bc", "ü"), ("%ff", "\u{FFFD}")] {
            assert_eq!(decode(odd), read);
        }
    }
}
