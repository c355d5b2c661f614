//! The pictures that a step names, where those are not frames t and t + 1.

use std::cell::RefCell;
use std::sync::Arc;

use motionscope_core::base::Error;
use motionscope_core::data::Frame;
use motionscope_core::run::Cursor;
use motionscope_core::scene::{Canvas, Picture, Pixels};

/// The pictures that a step names, as far as they can be had.
#[derive(Clone, Debug, Default)]
pub struct Named {
    /// Each by its name, in the order of the step.
    pub frames: Vec<(Picture, Arc<Frame>)>,
    /// The first that cannot be had, and why.
    pub missing: Option<(Picture, Error)>,
}

/// The pictures of the step that was looked at last: they are made once, and again where another row is pointed at.
#[derive(Default)]
pub struct LastNamed(RefCell<Option<(Cursor, Vec<Canvas>, Named)>>);

impl LastNamed {
    /// Those that the step at `cursor` names as `canvases`; `read` reads a frame of the clip by its name.
    pub fn of(
        &self,
        cursor: Cursor,
        canvases: &[Canvas],
        read: impl Fn(Picture) -> Result<Arc<Frame>, Error>,
    ) -> Named {
        if let Some((at, names, named)) = &*self.0.borrow()
            && (*at, &**names) == (cursor, canvases)
        {
            return named.clone();
        }
        let mut named = Named::default();
        for Canvas { picture, pixels, .. } in canvases {
            let frame = match pixels {
                Pixels::Made(make) => Ok(Arc::new(make())),
                Pixels::OfClip => read(*picture),
            };
            match frame {
                Ok(frame) => named.frames.push((*picture, frame)),
                Err(error) => named.missing = named.missing.or(Some((*picture, error))),
            }
        }
        *self.0.borrow_mut() = Some((cursor, canvases.to_vec(), named.clone()));
        named
    }
}

#[cfg(test)]
mod tests;
