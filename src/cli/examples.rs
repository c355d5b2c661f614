//! The examples in the help of the command line.

/// Of the command itself.
pub const ALL: &str = "\
Examples:
  motionscope                                    open the window at its start page
  motionscope ball.mp4                           open the window with your clip
  motionscope frame10.png frame11.png            open the window with two pictures as a clip
  motionscope list                               list estimators and their parameters
  motionscope run ball.mp4 --estimator full-search --frame 3 --set search-range=8 --overlay ball.png
  motionscope run synth:pillar --estimator full-search --json
  motionscope export synth:pillar --estimator full-search --steps 35..36 --out steps
  motionscope export synth:pillar --estimator diamond --steps 164..165 --animation diamond.gif

A CLIP is a video, an animation, an image of a numbered sequence, two pictures, a folder of
images, a printf pattern such as frame%02d.png, a session (*.motionscope), `-` for Y4M on
standard input, synth:NAME[,SLIDER=VALUE]... for a synthetic clip (see `motionscope synth --list`),
example:ESTIMATOR/ID for an example of an estimator (see `motionscope list ESTIMATOR`),
lesson:NAME/PAGE for a page of a lesson (see `motionscope lessons`), or a link in quotes, such
as '#lesson:kalman-filter/3' (see --link of `motionscope run`).";

/// Of `list`.
pub const LIST: &str = "\
Examples:
  motionscope list                               as text
  motionscope list --json                        as JSON: ids, parameters, ranges, defaults, units";

/// Of `glossary`.
pub const GLOSSARY: &str = "\
Examples:
  motionscope glossary                           all terms, by chapter
  motionscope glossary structure tensor          one definition
  motionscope glossary NIS --json                as JSON: term, aliases, symbol, definition, chapter";

/// Of `search`.
pub const SEARCH: &str = "\
Examples:
  motionscope search aperture problem            pages, terms, estimators, examples with both words
  motionscope search regularisation --json       as JSON: kind, title, place, excerpt, arguments that open it";
/// Of `camera`.
pub const CAMERA: &str = "\
Examples:
  motionscope camera --list                      all cameras and the test picture
  motionscope camera --out hand.y4m              3 seconds from the first camera
  motionscope camera --device test --seconds 5 --size 320x240 --out test.y4m";

/// Of `lessons`.
pub const LESSONS: &str = "\
Examples:
  motionscope lessons                            all lessons of the course
  motionscope lessons lesson:kalman-filter       the pages of one with their words
  motionscope lesson:kalman-filter/3             open the window with its third page
  motionscope week-4.md                          open the window with your own lesson";

/// Of `info`.
pub const INFO: &str = "\
Examples:
  motionscope info ball.mp4
  motionscope info frames/ball%03d.png --json
  motionscope info ball.webm --count             count frames by decoding the whole file
  motionscope info frame10.png --truth flow10.flo";

/// Of `synth`.
pub const SYNTH: &str = "\
Examples:
  motionscope synth --list                       list scenes, sliders and what they teach
  motionscope synth pillar --out pillar
  motionscope synth translation --out noisy --set noise=8 --set speed=2 --set frames=5";

/// Of `run`.
pub const RUN: &str = "\
Examples:
  motionscope run frame10.png --estimator full-search --truth flow10.flo --json
  motionscope run synth:pillar --estimator full-search --set block-size=8 --flow pillar.flo --table pillar.csv
  motionscope run synth:pillar --estimator full-search --step 35.412 --overlay step.svg
  motionscope run synth:pillar --estimator full-search --beside diamond,three-step --step 35.9 --overlay three.png
  motionscope run synth:pillar --estimator hierarchical --step 15.9 --level 2 --overlay coarse.png
  motionscope run frame10.png --estimator horn-schunck --layer error --legend --overlay error.png
  motionscope run frame10.png --estimator horn-schunck --step 20.1 --pixel 303,202 --caption --overlay pixel.png
  motionscope run synth:pillar --estimator full-search --pixel 30,20 --json
  motionscope run example:horn-schunck/filling-in --overlay fill.png
  motionscope run synth:pillar --estimator lucas-kanade --layer consistency --json
  motionscope run hall.mp4 --estimator mixture-of-gaussians --frames 0..99 --masks masks
  motionscope run --detections det.txt --truth gt.txt --estimator kalman-tracker --tracks tracks.txt --json
  motionscope run left.png --right right.png --calibration 721.5,0.54 --estimator block-stereo --disparity disparity.pfm
  motionscope run lesson.motionscope --overlay lesson.png --scale 4";

/// Of `export`.
pub const EXPORT: &str = "\
Examples:
  motionscope export synth:pillar --estimator full-search --steps 35..35.20 --out steps
  motionscope export synth:pillar --estimator full-search --steps 1..50 --every block --format svg --out blocks
  motionscope export synth:pillar --estimator diamond --steps 164..165 --caption --animation diamond.gif --rate 4
  motionscope export lesson:kalman-filter --format pdf --out pages   its pages, words beside pictures";

/// Of `compare`.
pub const COMPARE: &str = "\
Examples:
  motionscope compare synth:pillar --estimators full-search,three-step,diamond
  motionscope compare synth:pillar --estimators full-search,log-search --sweep search-range=4,8,16,32,64
  motionscope compare synth:pillar --estimators full-search,diamond --sweep noise=0,10,20,40 --csv noise.csv --plot noise.svg
  motionscope compare ball.mp4 --frame 7 --estimators full-search,hexagon --set block-size=8 --set hexagon.cost=ssd --markdown";
