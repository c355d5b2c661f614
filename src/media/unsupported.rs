//! Files that are not clips, detected by their first bytes.

use motionscope_core::base::Error;

use super::input;
use super::truth::mot;

/// Returns the error for a file that begins with `head` and is known not to be a clip: what it is, and what to do with it.
///
/// Without this check, ffmpeg would render text files as video.
pub(crate) fn refusal(head: &[u8]) -> Option<Error> {
    let starts = |magics: &[&[u8]]| magics.iter().any(|magic| head.starts_with(magic));
    let (is, hint) = if starts(&[b"PIEH"]) {
        ("the flow of a clip (.flo)", TRUTH)
    } else if starts(&[b"\x93NUMPY"]) {
        ("a NumPy array", "export its pictures as PNG and open those")
    } else if starts(&[b"%PDF"]) {
        ("a PDF document", "export its pictures as PNG, or give the video that it was made from")
    } else if starts(&[b"PK\x03\x04", b"Rar!", b"7z\xBC\xAF\x27\x1C", b"\x1F\x8B", b"BZh", b"\xFD7zXZ"]) {
        ("packed", "unpack it and open the clip in it")
    } else if starts(&[b"\x7FELF", b"MZ"]) {
        ("a program", CLIP)
    } else if !is_text(head) {
        return None;
    } else {
        let text = String::from_utf8_lossy(head);
        let text = text.trim_start_matches(input::MARK);
        let mut lines = text.lines().map(str::trim);
        if lines.any(|line| line.strip_prefix("motionscope").is_some_and(|rest| rest.trim().starts_with('='))) {
            ("a session", "give it a name that ends in .motionscope")
        } else if mot::is_detections(text) {
            ("a MOTChallenge file of detections", "give it with --detections, or a name that ends in .txt")
        } else if mot::is_objects(text) {
            ("a MOTChallenge file of tracks", TRUTH)
        } else {
            ("text", CLIP)
        }
    };
    Some(Error::new(format!("it is {is}, not a clip; {hint}")))
}

const TRUTH: &str = "open the clip beside it, or give it with --truth";
const CLIP: &str = "open a video, an animation, or a folder of pictures";

/// Whether this is text in any of the usual codes: no control characters, and mostly ASCII unless it is UTF-8.
fn is_text(head: &[u8]) -> bool {
    let is_control = |&byte: &u8| byte < b' ' && !matches!(byte, b'\t' | b'\n' | b'\r' | b'\x0C' | b'\x1B');
    // The head may end within a character.
    let is_utf8 = std::str::from_utf8(head).map_or_else(|error| error.valid_up_to() + 4 > head.len(), |_| true);
    let ascii = head.iter().filter(|byte| byte.is_ascii()).count();
    !head.iter().any(is_control) && (is_utf8 || 3 * ascii > 2 * head.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_file_is_and_what_to_do_is_reported() {
        let cases: [(&[u8], [&str; 2]); 14] = [
            (b"1,-1,10,20.5,30,40,0.9\n", ["detections", "--detections"]),
            (b"\xEF\xBB\xBF1;-1;10;20,5;30;40;0,9\n", ["detections", "--detections"]),
            (b"PIEH\x04\0\0\0", ["flow", "--truth"]),
            (b"1,1,10,20.5,30,40,1,1,0.9\n", ["MOTChallenge", "--truth"]),
            (b"\n 12, 3, -4, 20.5, 30, 40\r\n", ["MOTChallenge", "--truth"]),
            (b"# of Anna\nmotionscope = 1\nclip = \"a\"", ["session", ".motionscope"]),
            (b"%PDF-1.4\n%\xE2\xE3\xCF\xD3", ["PDF", "PNG"]),
            (b"PK\x03\x04\x14\0", ["packed", "unpack"]),
            (b"x,y\n1,2\n", ["text", "open a video"]),
            (b"Sch\xF6ne Gr\xFC\xDFe", ["text", "open a video"]),
            (b"motionscope is a program\n", ["text", "open a video"]),
            ("運動推定".as_bytes(), ["text", "open a video"]),
            (&"運動推定".as_bytes()[..11], ["text", "open a video"]),
            (b"\x1B[1mHELLO\x1B[0m", ["text", "open a video"]),
        ];
        for (head, words) in cases {
            let message = refusal(head).map(|error| error.to_string()).unwrap_or_default();
            assert!(words.iter().all(|word| message.contains(word)), "{head:?}: {message}");
        }
    }

    #[test]
    fn what_may_be_a_clip_is_left_to_ffmpeg() {
        let flv = b"FLV\x01\x05\0\0\0\x09".as_slice();
        let bright = [200, 210, 99, 220].repeat(9);
        for head in [flv, b"OggS\0\x02", b"\0\0\x01\xBA\x44", b"G@\x11\x10\0", b"FLV\n\x01", &bright] {
            assert!(refusal(head).is_none(), "{head:?}");
        }
    }
}
