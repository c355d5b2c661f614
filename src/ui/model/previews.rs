//! Pictures of the bundled samples, made on a thread of their own when they are first asked for: a still of each, and a film
//! of the one that is played.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};

use eframe::egui::{ColorImage, Context, TextureHandle, TextureOptions};
use motionscope_core::Clip;
use motionscope_core::synth::{SCENES, Sample};

/// Width and height of a picture in pixels.
pub const PICTURE_PX: (usize, usize) = (240, 180);
/// Pictures of a film per second.
const RATE: f64 = 10.0;
/// The number of no sample.
const NONE: usize = usize::MAX;

/// What the thread is asked for, by the number of a sample.
enum Order {
    Still(usize),
    Film(usize),
}

/// What it has made: the sample, which picture of its film unless it is the still, and the picture.
type Made = (usize, Option<usize>, ColorImage);

/// A still, once it was asked for and once it is there.
#[derive(Clone, Default)]
struct Still {
    is_asked: bool,
    texture: Option<TextureHandle>,
}

/// The film that is played.
struct Film {
    of: usize,
    /// When it began, in seconds.
    begun: f64,
    pictures: Vec<TextureHandle>,
}

/// The thread that makes pictures.
struct Maker {
    orders: Sender<Order>,
    made: Receiver<Made>,
    /// The sample whose film is wanted; the film of another one is left unfinished.
    wanted: Arc<AtomicUsize>,
}

/// The pictures of the samples.
#[derive(Default)]
pub struct Previews {
    stills: Vec<Still>,
    film: Option<Film>,
    maker: Option<Maker>,
}

impl Previews {
    /// Takes in what was made.
    pub fn receive(&mut self, ctx: &Context) {
        let Some(maker) = &self.maker else { return };
        for (of, number, image) in maker.made.try_iter() {
            let texture = || ctx.load_texture(format!("sample {of}"), image, TextureOptions::LINEAR);
            match (number, self.stills.get_mut(of), &mut self.film) {
                (None, Some(still), _) => still.texture = Some(texture()),
                (Some(number), _, Some(film)) if film.of == of && film.pictures.len() == number => {
                    film.pictures.push(texture());
                }
                _ => {}
            }
        }
    }

    /// The still of a sample, by its number; `None` until it is made.
    pub fn still(&mut self, ctx: &Context, of: usize) -> Option<&TextureHandle> {
        self.stills.resize_with(SCENES.len(), Still::default);
        let is_asked = self.stills.get_mut(of).map(|still| std::mem::replace(&mut still.is_asked, true));
        if is_asked == Some(false) {
            self.ask(ctx, Order::Still(of));
        }
        self.stills.get(of)?.texture.as_ref()
    }

    /// The picture of a sample that is played; the still until its film begins.
    pub fn playing(&mut self, ctx: &Context, of: usize) -> Option<&TextureHandle> {
        let now = ctx.input(|input| input.time);
        if self.film.as_ref().is_none_or(|film| film.of != of) {
            self.film = Some(Film { of, begun: now, pictures: Vec::new() });
            self.ask(ctx, Order::Film(of));
        }
        ctx.request_repaint_after_secs((1.0 / RATE) as f32);
        let at = self.film.as_ref().and_then(|film| {
            let count = film.pictures.len();
            (count > 1).then(|| ((now - film.begun) * RATE) as usize % count)
        });
        match at {
            Some(at) => self.film.as_ref()?.pictures.get(at),
            None => self.still(ctx, of),
        }
    }

    /// Whether all pictures that were asked for are there, and some were.
    pub fn is_complete(&self) -> bool {
        let mut asked = self.stills.iter().filter(|still| still.is_asked).peekable();
        asked.peek().is_some() && asked.all(|still| still.texture.is_some())
    }

    fn ask(&mut self, ctx: &Context, order: Order) {
        let maker = self.maker.get_or_insert_with(|| start(ctx.clone()));
        if let Order::Film(of) = order {
            maker.wanted.store(of, Ordering::Relaxed);
        }
        // Without a thread there are no pictures, only words.
        maker.orders.send(order).ok();
    }
}

fn start(ctx: Context) -> Maker {
    let (orders, waiting) = channel();
    let (sender, made) = channel();
    let wanted = Arc::new(AtomicUsize::new(NONE));
    let still_wanted = Arc::clone(&wanted);
    let work = move || {
        let send = |made: Made| {
            let is_heard = sender.send(made).is_ok();
            ctx.request_repaint();
            is_heard
        };
        for order in waiting {
            match order {
                Order::Still(of) => drop(still(of).map(|image| send((of, None, image)))),
                Order::Film(of) => film(of, |number, image| {
                    still_wanted.load(Ordering::Relaxed) == of && send((of, Some(number), image))
                }),
            }
        }
    };
    drop(std::thread::Builder::new().name("sample clips".into()).spawn(work));
    Maker { orders, made, wanted }
}

fn still(of: usize) -> Option<ColorImage> {
    let (clip, frames) = small(SCENES.get(of)?)?;
    picture(&clip, frames / 3)
}

/// Makes the pictures of a film as long as `next` takes them.
fn film(of: usize, mut next: impl FnMut(usize, ColorImage) -> bool) {
    let Some((clip, frames)) = SCENES.get(of).and_then(small) else { return };
    for number in 0..frames {
        let Some(image) = picture(&clip, number) else { return };
        if !next(number, image) {
            return;
        }
    }
}

/// The clip of a sample in small, and its number of frames.
fn small(sample: &Sample) -> Option<(Clip, usize)> {
    let mut difficulty = sample.difficulty();
    (difficulty.width, difficulty.height) = PICTURE_PX;
    Some((sample.clip(&difficulty).ok()?, difficulty.frames))
}

fn picture(clip: &Clip, number: usize) -> Option<ColorImage> {
    let frame = clip.frame(number).ok()?;
    let (width, height) = frame.size();
    let bytes: Vec<u8> = match frame.color() {
        Some(rgb) => rgb.cells().iter().flatten().copied().collect(),
        None => frame.luma().cells().iter().flat_map(|&v| [v; 3]).collect(),
    };
    Some(ColorImage::from_rgb([width, height], &bytes))
}

#[cfg(test)]
mod tests {
    use std::time::{Duration, Instant};

    use super::*;

    /// Draws frames in `ctx` until `is_done`.
    fn until(ctx: &Context, previews: &mut Previews, mut is_done: impl FnMut(&mut Previews, &Context) -> bool) {
        let begun = Instant::now();
        let mut done = false;
        while !done {
            let mut output = ctx.run_ui(Default::default(), |ui| {
                previews.receive(ui.ctx());
                done = is_done(previews, ui.ctx());
            });
            output.textures_delta.clear();
            assert!(begun.elapsed() < Duration::from_secs(30));
            std::thread::sleep(Duration::from_millis(2));
        }
    }

    #[test]
    fn only_what_is_asked_for_is_made_and_another_film_ends_the_first() {
        let (ctx, mut previews) = (Context::default(), Previews::default());
        assert!(!previews.is_complete());
        until(&ctx, &mut previews, |previews, ctx| previews.still(ctx, 2).is_some());
        assert!(previews.is_complete());
        assert_eq!(previews.stills.iter().filter(|still| still.texture.is_some()).count(), 1);
        let moves = |previews: &mut Previews, ctx: &Context, of| {
            previews.playing(ctx, of);
            previews.film.as_ref().is_some_and(|film| film.of == of && film.pictures.len() > 2)
        };
        until(&ctx, &mut previews, |previews, ctx| moves(previews, ctx, 2));
        until(&ctx, &mut previews, |previews, ctx| moves(previews, ctx, 0));
        assert!(previews.still(&ctx, SCENES.len()).is_none(), "there is no such sample");
    }
}
