//! The list of cameras, as the system and ffmpeg print it.

use std::fs;
use std::path::Path;

use super::Device;

/// How ffmpeg reaches the cameras of an operating system.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Platform {
    /// Video4Linux.
    Linux,
    /// AVFoundation.
    MacOs,
    /// DirectShow.
    Windows,
}

impl Platform {
    /// The one that this program runs on.
    pub fn here() -> Self {
        match std::env::consts::OS {
            "macos" => Self::MacOs,
            "windows" => Self::Windows,
            _ => Self::Linux,
        }
    }

    /// ffmpeg's name of the input.
    pub(super) fn input(self) -> &'static str {
        match self {
            Self::Linux => "v4l2",
            Self::MacOs => "avfoundation",
            Self::Windows => "dshow",
        }
    }

    /// The arguments with which ffmpeg lists the cameras.
    pub(super) fn listing(self) -> &'static [&'static str] {
        match self {
            Self::Linux => &["-hide_banner", "-sources", "v4l2"],
            Self::MacOs => &["-hide_banner", "-f", "avfoundation", "-list_devices", "true", "-i", ""],
            Self::Windows => &["-hide_banner", "-f", "dshow", "-list_devices", "true", "-i", "dummy"],
        }
    }

    /// The cameras in the text that ffmpeg printed.
    pub fn parse(self, printed: &str) -> Vec<Device> {
        match self {
            Self::Linux => printed.lines().filter_map(v4l2).collect(),
            Self::MacOs => avfoundation(printed),
            Self::Windows => dshow(printed),
        }
    }
}

/// A line of `-sources v4l2`: `* /dev/video0 [HD Webcam: HD Webcam] (none)`.
fn v4l2(line: &str) -> Option<Device> {
    let line = line.trim_start_matches(['*', ' ']);
    let (address, rest) = line.split_once(" [")?;
    let name = rest.rsplit_once(']')?.0;
    address.starts_with("/dev/").then(|| camera(plain(name), address))
}

/// A name without its repetition behind a colon, which drivers of webcams add.
fn plain(name: &str) -> &str {
    match name.split_once(": ") {
        Some((first, second)) if first.starts_with(second.trim_end()) => first,
        _ => name.trim(),
    }
}

/// The cameras among the numbered devices that macOS lists.
fn avfoundation(printed: &str) -> Vec<Device> {
    // Each line begins with its origin in brackets.
    let lines = printed.lines().filter_map(|line| line.split_once("] ").map(|(_, rest)| rest.trim()));
    let videos = lines.skip_while(|line| !line.contains("video devices")).skip(1);
    let videos = videos.take_while(|line| !line.contains("audio devices"));
    let device = |line: &str| {
        let (number, name) = line.strip_prefix('[')?.split_once("] ")?;
        number.parse::<u32>().ok()?;
        Some(camera(name, format!("{number}:none")))
    };
    videos.filter_map(device).collect()
}

/// The cameras among the quoted devices that Windows lists; its other name, which is unique, is the address.
fn dshow(printed: &str) -> Vec<Device> {
    let (mut found, mut is_video) = (Vec::new(), true);
    for line in printed.lines().filter_map(|line| line.split_once("] ").map(|(_, rest)| rest.trim())) {
        let quoted = line.split_once('"').and_then(|(before, rest)| Some((before, rest.rsplit_once('"')?)));
        match quoted {
            // Versions before 5.0 list each kind under a heading.
            None if line.contains("DirectShow") => is_video = line.contains("video devices"),
            Some((before, (other, _))) if before.starts_with("Alternative") => {
                if let (true, Some(Device::Camera { address, .. })) = (is_video, found.last_mut()) {
                    *address = format!("video={other}");
                }
            }
            Some(("", (name, kind))) => {
                let kind = kind.trim();
                is_video = if kind.is_empty() { is_video } else { kind != "(audio)" };
                found.extend(is_video.then(|| camera(name, format!("video={name}"))));
            }
            _ => {}
        }
    }
    found
}

fn camera(name: impl Into<String>, address: impl Into<String>) -> Device {
    Device::Camera { name: name.into(), address: address.into() }
}

/// The cameras in `folder`, where Linux describes them: `/sys/class/video4linux`. A camera may have more than one device: only
/// the first has pictures.
pub(super) fn described(folder: &Path) -> Vec<Device> {
    let text = |path: &Path| fs::read_to_string(path).ok().map(|text| text.trim().to_owned());
    let number = |name: &str| name.strip_prefix("video").and_then(|number| number.parse::<u32>().ok());
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let mut found: Vec<_> = entries
        .filter_map(|entry| {
            let (file, path) = (entry.file_name().into_string().ok()?, entry.path());
            let is_first = text(&path.join("index")).is_none_or(|index| index == "0");
            let name = text(&path.join("name")).filter(|_| is_first)?;
            Some((number(&file)?, camera(plain(&name), format!("/dev/{file}"))))
        })
        .collect();
    found.sort_by_key(|(number, _)| *number);
    found.into_iter().map(|(_, device)| device).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pairs(devices: &[Device]) -> Vec<(&str, &str)> {
        let all = devices.iter().map(|device| match device {
            Device::Camera { name, address } => (name.as_str(), address.as_str()),
            Device::TestPicture => ("", ""),
        });
        all.collect()
    }

    #[test]
    fn linux() {
        let printed = "Auto-detected sources for v4l2:\n  /dev/video0 [Integrated Camera: Integrated C] (none)\n\
                       * /dev/video2 [Logitech BRIO] (none)\n";
        assert_eq!(
            pairs(&Platform::Linux.parse(printed)),
            [("Integrated Camera", "/dev/video0"), ("Logitech BRIO", "/dev/video2")]
        );
        assert!(Platform::Linux.parse("Cannot list sources: Function not implemented\n").is_empty());
    }

    #[test]
    fn linux_describes_its_devices_in_files() {
        let folder = tempfile::tempdir().unwrap();
        let all =
            [("video10", "USB Camera", "0"), ("video2", "HD: HD", "0"), ("video3", "HD: HD", "1"), ("vbi0", "x", "0")];
        for (device, name, index) in all {
            let folder = folder.path().join(device);
            fs::create_dir(&folder).unwrap();
            fs::write(folder.join("name"), format!("{name}\n")).unwrap();
            fs::write(folder.join("index"), format!("{index}\n")).unwrap();
        }
        let found = described(folder.path());
        assert_eq!(pairs(&found), [("HD", "/dev/video2"), ("USB Camera", "/dev/video10")]);
        assert!(described(&folder.path().join("absent")).is_empty());
    }

    #[test]
    fn macos() {
        let printed = "\
[AVFoundation indev @ 0x14e004d40] AVFoundation video devices:
[AVFoundation indev @ 0x14e004d40] [0] FaceTime HD Camera
[AVFoundation indev @ 0x14e004d40] [1] Ada’s iPhone [Desk View] Camera
[AVFoundation indev @ 0x14e004d40] [2] Capture screen 0
[AVFoundation indev @ 0x14e004d40] AVFoundation audio devices:
[AVFoundation indev @ 0x14e004d40] [0] MacBook Pro Microphone
: Input/output error
";
        assert_eq!(
            pairs(&Platform::MacOs.parse(printed)),
            [
                ("FaceTime HD Camera", "0:none"),
                ("Ada’s iPhone [Desk View] Camera", "1:none"),
                ("Capture screen 0", "2:none"),
            ]
        );
    }

    #[test]
    fn windows_of_today() {
        let printed = r#"[dshow @ 000001d6a3c5f0c0] "Integrated Camera" (video)
[dshow @ 000001d6a3c5f0c0]   Alternative name "@device_pnp_\\?\usb#vid_04f2&pid_b6cb#global"
[dshow @ 000001d6a3c5f0c0] "OBS Virtual Camera" (none)
[dshow @ 000001d6a3c5f0c0]   Alternative name "@device_sw_{860BB310}\{A3FCE0F5}"
[dshow @ 000001d6a3c5f0c0] "Microphone Array (Realtek(R) Audio)" (audio)
[dshow @ 000001d6a3c5f0c0]   Alternative name "@device_cm_{33D9A762}\wave_{0A}"
dummy: Immediate exit requested
"#;
        assert_eq!(
            pairs(&Platform::Windows.parse(printed)),
            [
                ("Integrated Camera", r"video=@device_pnp_\\?\usb#vid_04f2&pid_b6cb#global"),
                ("OBS Virtual Camera", r"video=@device_sw_{860BB310}\{A3FCE0F5}"),
            ]
        );
    }

    #[test]
    fn windows_of_before() {
        let printed = r#"[dshow @ 0000020b] DirectShow video devices (some may be both video and audio devices)
[dshow @ 0000020b]  "USB2.0 HD UVC WebCam"
[dshow @ 0000020b]     Alternative name "@device_pnp_\\?\usb#vid_13d3"
[dshow @ 0000020b] DirectShow audio devices
[dshow @ 0000020b]  "Microphone (USB)"
[dshow @ 0000020b]     Alternative name "@device_cm_{33D9}\wave"
dummy: Immediate exit requested
"#;
        let found = Platform::Windows.parse(printed);
        assert_eq!(pairs(&found), [("USB2.0 HD UVC WebCam", r"video=@device_pnp_\\?\usb#vid_13d3")]);
        assert!(Platform::Windows.parse("Could not enumerate video devices (or none found).\n").is_empty());
    }
}
