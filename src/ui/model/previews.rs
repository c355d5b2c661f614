//! Pictures of the bundled samples, made by a task when they are first asked for: a still of each, and a film
//! of the one that is played.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};

use eframe::egui::{ColorImage, Context, TextureHandle, TextureOptions};
use motionscope_core::data::Clip;
use motionscope_core::synth::{SCENES, Sample};

use super::step_pictures::StepPictures;
use crate::work::{self, Signal};

/// Width and height of a picture in pixels.
pub const PICTURE_PX: (usize, usize) = (240, 180);
/// Pictures of a film per second.
const RATE: f64 = 10.0;
/// Times that a film plays before it rests.
const TIMES: usize = 3;
/// The number of no order.
const NONE: usize = usize::MAX;

/// A request to the task.
enum Order {
    /// The still of the sample with this number.
    Still(usize),
    /// The film of a sample, and the number of the order.
    Film(usize, usize),
    /// Nothing any more.
    Quit,
}

/// What it has made.
enum Made {
    /// The still of a sample; `None` if it cannot be made.
    Still(usize, Option<ColorImage>),
    /// The next picture of the film of an order.
    Picture(usize, ColorImage),
    /// The end of the film of an order.
    End(usize),
}

/// Why a sample is to be played: the pointer wins over the keyboard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wish {
    /// The pointer is over its card.
    Hovered,
    /// Its card has the keyboard.
    Focused,
}

/// A still, from when it is asked for.
#[derive(Clone, Default)]
struct Still {
    is_asked: bool,
    /// Whether it was made, or cannot be made.
    is_done: bool,
    texture: Option<TextureHandle>,
}

/// The film that is played.
struct Film {
    of: usize,
    /// The number of its order.
    order: usize,
    /// When its first picture was shown, in seconds.
    begun: f64,
    pictures: Vec<TextureHandle>,
    /// Whether all its pictures are there.
    is_whole: bool,
}

impl Film {
    fn push(&mut self, picture: TextureHandle, now: f64) {
        if self.pictures.is_empty() {
            self.begun = now;
        }
        self.pictures.push(picture);
    }

    /// Notes that no more pictures come: behind the last one, which may have been shown for long, it begins again.
    fn end(&mut self, now: f64) {
        let last = self.pictures.len().saturating_sub(1);
        self.begun = self.begun.max(now - last as f64 / RATE);
        self.is_whole = true;
    }

    /// The number of pictures due since the film began.
    fn due(&self, now: f64) -> usize {
        ((now - self.begun) * RATE + 1e-6) as usize
    }

    /// The index of the picture that is shown; until all are there, and after the last time, the last one stays.
    fn at(&self, now: f64) -> usize {
        let (count, due) = (self.pictures.len().max(1), self.due(now));
        if self.is_whole && !self.is_over(now) { due % count } else { due.min(count - 1) }
    }

    /// Whether the film has played often enough; repainting then stops.
    fn is_over(&self, now: f64) -> bool {
        self.is_whole && self.due(now) >= TIMES * self.pictures.len()
    }
}

/// The task that makes pictures.
struct Maker {
    /// Tells the task that there is an order.
    ordered: Arc<Signal>,
    orders: Sender<Order>,
    made: Receiver<Made>,
    /// The order of the film that is wanted; every other film is left out or left unfinished.
    wanted: Arc<AtomicUsize>,
}

/// The pictures of the samples.
#[derive(Default)]
pub struct Previews {
    stills: Vec<Still>,
    film: Option<Film>,
    /// Films that were ordered so far.
    ordered: usize,
    /// The samples that are to be played in the frame that is being drawn.
    hovered: Option<usize>,
    focused: Option<usize>,
    maker: Option<Maker>,
    /// The pictures of the estimators.
    pub steps: StepPictures,
}

impl Previews {
    /// Takes in what was made.
    pub fn receive(&mut self, ctx: &Context) {
        let Some(maker) = &self.maker else { return };
        let now = ctx.input(|input| input.time);
        let load = |image: ColorImage| ctx.load_texture("sample", image, TextureOptions::LINEAR);
        for made in maker.made.try_iter() {
            match made {
                Made::Still(of, image) => {
                    if let Some(still) = self.stills.get_mut(of) {
                        (still.is_done, still.texture) = (true, image.map(load));
                    }
                }
                Made::Picture(order, image) => {
                    if let Some(film) = self.film.as_mut().filter(|film| film.order == order) {
                        film.push(load(image), now);
                    }
                }
                Made::End(order) => {
                    if let Some(film) = self.film.as_mut().filter(|film| film.order == order) {
                        film.end(now);
                    }
                }
            }
        }
    }

    /// The picture of a sample, by its number: one of its film while that is played, else the still; `None` until it is made.
    pub fn picture(&mut self, ctx: &Context, of: usize, wish: Option<Wish>) -> Option<&TextureHandle> {
        match wish {
            Some(Wish::Hovered) => self.hovered = Some(of),
            Some(Wish::Focused) => self.focused = Some(of),
            None => {}
        }
        let now = ctx.input(|input| input.time);
        let film = self.film.as_ref().filter(|film| film.of == of && film.pictures.len() > 1);
        match film.map(|film| film.at(now)) {
            Some(at) => self.film.as_ref()?.pictures.get(at),
            None => self.still(ctx, of),
        }
    }

    fn still(&mut self, ctx: &Context, of: usize) -> Option<&TextureHandle> {
        self.stills.resize_with(SCENES.len(), Still::default);
        let is_asked = self.stills.get_mut(of).map(|still| std::mem::replace(&mut still.is_asked, true));
        if is_asked == Some(false) && !self.ask(ctx, Order::Still(of)) {
            // Without a task there are no pictures, only words.
            self.stills[of].is_done = true;
        }
        self.stills.get(of)?.texture.as_ref()
    }

    /// Ends a frame: one sample that was wished for in it is played from the next frame on, and no other.
    pub fn settle(&mut self, ctx: &Context) {
        self.steps.settle(ctx);
        let (hovered, focused) = (self.hovered.take(), self.focused.take());
        match hovered.or(focused) {
            Some(of) if self.film.as_ref().is_none_or(|film| film.of != of) => self.begin(ctx, of),
            Some(_) => {}
            None => self.stop(),
        }
        let now = ctx.input(|input| input.time);
        if self.film.as_ref().is_some_and(|film| !film.is_over(now)) {
            ctx.request_repaint_after_secs((1.0 / RATE) as f32);
        }
    }

    fn begin(&mut self, ctx: &Context, of: usize) {
        self.ordered += 1;
        let order = self.ordered;
        self.film = Some(Film { of, order, begun: 0.0, pictures: Vec::new(), is_whole: false });
        self.ask(ctx, Order::Film(of, order));
    }

    /// Plays no film any more, and makes no more pictures of one.
    fn stop(&mut self) {
        self.film = None;
        self.maker.iter().for_each(|maker| maker.wanted.store(NONE, Ordering::Relaxed));
    }

    /// Whether all stills that were asked for are there or cannot be made, and some were asked for.
    pub fn is_complete(&self) -> bool {
        let mut asked = self.stills.iter().filter(|still| still.is_asked).peekable();
        asked.peek().is_some() && asked.all(|still| still.is_done)
    }

    /// Gives `order` to the task; returns whether there is one.
    fn ask(&mut self, ctx: &Context, order: Order) -> bool {
        let maker = self.maker.get_or_insert_with(|| start(ctx.clone()));
        if let Order::Film(_, number) = order {
            maker.wanted.store(number, Ordering::Relaxed);
        }
        maker.order(order)
    }
}

impl Maker {
    fn order(&self, order: Order) -> bool {
        let is_heard = self.orders.send(order).is_ok();
        self.ordered.notify();
        is_heard
    }
}

impl Drop for Maker {
    fn drop(&mut self) {
        self.wanted.store(NONE, Ordering::Relaxed);
        self.order(Order::Quit);
    }
}

fn start(ctx: Context) -> Maker {
    let (orders, waiting) = channel();
    let (sender, made) = channel();
    let (wanted, ordered) = (Arc::new(AtomicUsize::new(NONE)), Arc::<Signal>::default());
    let (still_wanted, has_order) = (Arc::clone(&wanted), Arc::clone(&ordered));
    let work = async move || {
        let send = |made: Made| {
            let is_heard = sender.send(made).is_ok();
            ctx.request_repaint();
            is_heard
        };
        loop {
            match has_order.until(|| waiting.try_recv().ok()).await {
                Order::Still(of) => _ = send(Made::Still(of, still(of))),
                Order::Film(of, number) => {
                    let is_wanted = || still_wanted.load(Ordering::Relaxed) == number;
                    let next = |image| is_wanted() && send(Made::Picture(number, image));
                    if is_wanted() && film(of, next).await {
                        send(Made::End(number));
                    }
                }
                Order::Quit => return,
            }
            work::breathe().await;
        }
    };
    // Without a task an order has no effect.
    drop(work::spawn("sample clips", work));
    Maker { ordered, orders, made, wanted }
}

fn still(of: usize) -> Option<ColorImage> {
    let (clip, frames) = small(SCENES.get(of)?)?;
    picture(&clip, frames / 3)
}

/// Makes the pictures of a film as long as `next` takes them; returns whether it took all that can be made.
async fn film(of: usize, mut next: impl FnMut(ColorImage) -> bool) -> bool {
    let Some((clip, frames)) = SCENES.get(of).and_then(small) else { return true };
    for image in (0..frames).map_while(|number| picture(&clip, number)) {
        if !next(image) {
            return false;
        }
        work::breathe().await;
    }
    true
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
    use web_time::{Duration, Instant};

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
        until(&ctx, &mut previews, |previews, ctx| previews.picture(ctx, 2, None).is_some());
        assert!(previews.is_complete());
        assert_eq!(previews.stills.iter().filter(|still| still.texture.is_some()).count(), 1);
        let moves = |previews: &mut Previews, ctx: &Context, of| {
            previews.picture(ctx, of, Some(Wish::Hovered));
            previews.settle(ctx);
            previews.film.as_ref().is_some_and(|film| film.of == of && film.pictures.len() > 2)
        };
        until(&ctx, &mut previews, |previews, ctx| moves(previews, ctx, 2));
        until(&ctx, &mut previews, |previews, ctx| moves(previews, ctx, 0));
        assert!(previews.picture(&ctx, SCENES.len(), None).is_none(), "there is no such sample");
        previews.settle(&ctx);
        assert!(previews.film.is_none(), "where none is wished for, none is played");
        let wanted = previews.maker.as_ref().map(|maker| maker.wanted.load(Ordering::Relaxed));
        assert_eq!(wanted, Some(NONE), "and no more pictures are made");
    }

    #[test]
    fn of_a_card_under_the_pointer_and_one_with_the_keyboard_the_first_alone_plays() {
        let (ctx, mut previews) = (Context::default(), Previews::default());
        for frame in 0..100 {
            let mut cards = [(1, Wish::Hovered), (2, Wish::Focused)];
            cards.rotate_left(frame % 2);
            let mut output = ctx.run_ui(Default::default(), |ui| {
                previews.receive(ui.ctx());
                for (of, wish) in cards {
                    previews.picture(ui.ctx(), of, Some(wish));
                }
                previews.settle(ui.ctx());
            });
            output.textures_delta.clear();
        }
        assert_eq!((previews.ordered, previews.film.map(|film| film.of)), (1, Some(1)));
    }

    #[test]
    fn a_film_waits_at_its_last_picture_until_all_are_there() {
        let ctx = Context::default();
        let picture = || ctx.load_texture("", ColorImage::from_rgb([1, 1], &[0; 3]), TextureOptions::LINEAR);
        let mut film = Film { of: 0, order: 1, begun: 0.0, pictures: Vec::new(), is_whole: false };
        (0..3).for_each(|_| film.push(picture(), 5.0));
        assert_eq!([5.0, 5.15, 5.25, 9.0].map(|now| film.at(now)), [0, 1, 2, 2]);
        film.end(9.0);
        assert_eq!([9.0, 9.15, 9.25].map(|now| film.at(now)), [2, 0, 1], "no picture is left out");
        assert_eq!([9.55, 9.75, 99.0].map(|now| film.at(now)), [1, 2, 2], "it rests after the last time");
        assert_eq!([9.65, 9.75].map(|now| film.is_over(now)), [false, true]);
    }

    #[test]
    fn a_still_that_cannot_be_made_is_not_waited_for() {
        let stills = vec![Still { is_asked: true, ..Still::default() }];
        let mut previews = Previews { stills, ..Previews::default() };
        assert!(!previews.is_complete());
        let (orders, _waiting) = channel();
        let (sender, made) = channel();
        previews.maker =
            Some(Maker { ordered: Arc::default(), orders, made, wanted: Arc::new(AtomicUsize::new(NONE)) });
        sender.send(Made::Still(0, None)).expect("it is heard");
        previews.receive(&Context::default());
        assert!(previews.is_complete());
    }
}
