//! An MP4 file of encoded pictures, with its tables at the front, so that a player need not wait for the end.

use std::num::NonZeroU32;

use shiguredo_mp4::TrackKind;
use shiguredo_mp4::boxes::{Avc1Box, AvccBox, SampleEntry, UnknownBox, VisualSampleEntryFields as Visual};
use shiguredo_mp4::mux::{Mp4FileMuxer, Mp4FileMuxerOptions, Sample, estimate_maximum_moov_box_size};
use shiguredo_mp4::{BoxSize, BoxType, Decode as _, Uint};

/// Colours as high definition has them (BT.709) in the narrow range, as the box `colr` of ISO/IEC 14496-12 names them.
const COLORS: [u8; 11] = *b"nclx\0\x01\0\x01\0\x01\0";
/// The first profile whose configuration names the format of its samples.
const HIGH: u8 = 100;
/// Bytes of a box before its content.
const HEADER: usize = 8;

/// An encoded picture.
#[derive(PartialEq)]
pub struct Picture {
    /// Units of H.264, each after its length.
    pub bytes: Vec<u8>,
    /// Whether it can be decoded without those before it.
    pub is_key: bool,
    /// Its place in the order in which pictures are shown, from 0.
    pub number: usize,
}

/// Encoded pictures in the order in which they are decoded.
pub struct Stream {
    /// Width and height in px.
    pub size: [u16; 2],
    /// The frame rate as a fraction: frames, and seconds.
    pub rate: [u32; 2],
    /// The record of the decoder's configuration (ISO/IEC 14496-15, 5.3.3.1).
    pub configuration: Vec<u8>,
    /// The pictures.
    pub pictures: Vec<Picture>,
}

impl Stream {
    /// The file.
    ///
    /// # Errors
    /// If there is no picture, or the configuration is damaged.
    pub fn into_file(self) -> Result<Vec<u8>, String> {
        let why = |error: &dyn std::fmt::Display| error.to_string();
        if self.pictures.is_empty() {
            return Err("there is no picture".into());
        }
        let tables = estimate_maximum_moov_box_size(&[self.pictures.len()]);
        let options = Mp4FileMuxerOptions { reserved_moov_box_size: tables, ..Default::default() };
        let mut muxer = Mp4FileMuxer::with_options(options).map_err(|error| why(&error))?;
        let mut file = muxer.initial_boxes_bytes().to_vec();
        let (mut entry, [frames, seconds]) = (Some(self.entry()?), self.rate);
        let is_reordered = self.pictures.iter().enumerate().any(|(place, picture)| place != picture.number);
        for (place, Picture { bytes, is_key, number }) in self.pictures.into_iter().enumerate() {
            let later = number as i64 - place as i64;
            let sample = Sample {
                track_kind: TrackKind::Video,
                sample_entry: entry.take(),
                keyframe: is_key,
                timescale: NonZeroU32::new(frames).unwrap_or(NonZeroU32::MIN),
                duration: seconds,
                composition_time_offset: is_reordered.then_some(later * i64::from(seconds)),
                data_offset: file.len() as u64,
                data_size: bytes.len(),
            };
            file.extend_from_slice(&bytes);
            muxer.append_sample(&sample).map_err(|error| why(&error))?;
        }
        for (offset, bytes) in muxer.finalize().map_err(|error| why(&error))?.offset_and_bytes_pairs() {
            let begin = usize::try_from(offset).map_err(|error| why(&error))?;
            let end = begin + bytes.len();
            file.resize(file.len().max(end), 0);
            file[begin..end].copy_from_slice(bytes);
        }
        Ok(file)
    }

    fn entry(&self) -> Result<SampleEntry, String> {
        let size = u32::try_from(HEADER + self.configuration.len()).map_err(|error| error.to_string())?;
        let record = [&size.to_be_bytes(), b"avcC".as_slice(), &self.configuration].concat();
        let (mut avcc_box, _) = AvccBox::decode(&record).map_err(|error| error.to_string())?;
        if avcc_box.avc_profile_indication >= HIGH {
            // Some encoders leave it out: 4:2:0 in 8 bit.
            avcc_box.chroma_format.get_or_insert(Uint::new(1));
            avcc_box.bit_depth_luma_minus8.get_or_insert(Uint::new(0));
            avcc_box.bit_depth_chroma_minus8.get_or_insert(Uint::new(0));
        }
        let [width, height] = self.size;
        let visual = Visual {
            data_reference_index: Visual::DEFAULT_DATA_REFERENCE_INDEX,
            width,
            height,
            horizresolution: Visual::DEFAULT_HORIZRESOLUTION,
            vertresolution: Visual::DEFAULT_VERTRESOLUTION,
            frame_count: Visual::DEFAULT_FRAME_COUNT,
            compressorname: Visual::NULL_COMPRESSORNAME,
            depth: Visual::DEFAULT_DEPTH,
        };
        let colors = UnknownBox {
            box_type: BoxType::Normal(*b"colr"),
            box_size: BoxSize::U32((HEADER + COLORS.len()) as u32),
            payload: COLORS.to_vec(),
        };
        Ok(SampleEntry::Avc1(Avc1Box { visual, avcc_box, unknown_boxes: vec![colors] }))
    }
}
