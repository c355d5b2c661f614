//! The values and cases of a background subtraction.

use crate::scene::{Decimals, Role, Unit};

/// A number of pixels.
pub(super) const AREA: Unit = Unit::new("px", 0);
/// A change of the exposure.
const EXPOSURE: Unit = Unit::new("gray levels", 1);
const SIGNED_EXPOSURE: Unit = Unit { name: "gray levels", decimals: Decimals::Signed(1) };

crate::variables! { pub(crate) mod value;
    /// The number of the current frame.
    FRAME: "Frame", "t", Unit::WHOLE;
    /// The next frame, which is compared with the current one.
    NEXT_FRAME: "", "", Unit::WHOLE;
    /// The last frame of the median that initialises the model.
    LAST_FRAME: "", "", Unit::WHOLE;
    /// The quantity that is compared with the threshold.
    COMPARED: "", "", Unit::WHOLE;
    /// The formula of the heat map.
    SHOWN: "", "", Unit::WHOLE;
    /// The explained pixel.
    PIXEL: "Pixel", r"\mathbf{x}", Unit::WHOLE, Role::Reference;
    /// The gray level of the pixel before the exposure was corrected.
    UNCORRECTED_LEVEL: "Level before the correction", "", Unit::WHOLE, Role::Measured;
    /// The gray level of the pixel in the frame.
    GRAY_LEVEL: "Gray level", "I", Unit::WHOLE, Role::Measured;
    /// The colour of the pixel in the frame: red, green and blue.
    COLOUR: "Colour", r"\mathbf{I}", Unit::WHOLE, Role::Measured;
    /// The background that the model expects at the pixel.
    BACKGROUND: "Background", "B", Unit::FINE, Role::Predicted;
    /// The background at the pixel after the update.
    BACKGROUND_AFTER: "Background after update", "B", Unit::FINE, Role::Estimate;
    /// The difference of the pixel from the background, in colour the largest of all channels.
    DIFFERENCE: "Difference", "|I - B|", Unit::GRAY;
    /// The colour channel that decides.
    CHANNEL: "Channel", "", Unit::WHOLE;
    /// The threshold on the difference of foreground pixels.
    THRESHOLD: "Threshold", "T", Unit::GRAY;
    /// The threshold in standard deviations of the noise, where it follows from that.
    NOISE_SIGMAS: "", "", Unit::WHOLE;
    /// The level of the pixel in the channel that decides.
    LEVEL: "", "I", Unit::WHOLE, Role::Measured;
    /// The background in the channel that decides.
    EXPECTED: "", "B", Unit::FINE, Role::Predicted;
    /// The learning rate of the model.
    LEARNING_RATE: "", r"\alpha", Unit::RATIO;
    /// The displacement of the background since the first frame, by the camera.
    CAMERA: "Camera displacement", "", Unit::PX, Role::Reference;
    /// The shift of the model since the previous frame.
    SHIFT: "", "", Unit::PX;
    /// The median change of the gray levels from the background to the frame.
    EXPOSURE_CHANGE: "Change of exposure", "", SIGNED_EXPOSURE, Role::Reference;
    /// The size of the change of exposure.
    EXPOSURE_SIZE: "", "", EXPOSURE, Role::Reference;
    /// The change of dark pixels, at gray level 64.
    DARK_CHANGE: "", "", SIGNED_EXPOSURE;
    /// The change of bright pixels, at gray level 192.
    BRIGHT_CHANGE: "", "", SIGNED_EXPOSURE;
    /// The pixels that differ from the background by more than the threshold.
    FOREGROUND: "Foreground by the threshold", "", AREA, Role::Candidate;
    /// The share of the frame that differs from the background by more than the threshold.
    FOREGROUND_SHARE: "", "", Unit::PERCENT;
    /// The pixels that are cast shadows.
    SHADOWS: "Shadows", "", AREA, Role::Rejected;
    /// The foreground pixels that fit the background of a neighbour.
    DISPLACED: "Displaced background", "", AREA, Role::Rejected;
    /// The radius of the shake suppression.
    SHAKE: "", "", AREA;
    /// The area below which the area opening removes a component.
    LEAST_COMPONENT: "", "", AREA;
    /// The pixels that the openings remove.
    REMOVED: "", "", AREA, Role::Rejected;
    /// The pixels of the mask after the openings.
    AFTER_OPENING: "After opening", "", AREA;
    /// The side of the structuring element of the opening or closing.
    SIDE: "", "", Unit::WHOLE;
    /// The pixels that the closing adds.
    FILLED: "", "", AREA, Role::Estimate;
    /// The pixels of the mask after the closing.
    AFTER_CLOSING: "After closing", "", AREA;
    /// The number of neighbours that count as connected.
    CONNECTIVITY: "", "", Unit::WHOLE;
    /// The connected components of the mask.
    COMPONENTS: "Components", "", Unit::count("connected component"), Role::Candidate;
    /// The number of the component that the pixel belongs to.
    COMPONENT: "", "", Unit::WHOLE;
    /// The components of at least the minimum area.
    BLOBS: "Blobs", "", Unit::count("blob"), Role::Result;
    /// The components below the minimum area.
    SMALL_COMPONENTS: "", "", Unit::count("smaller component"), Role::Rejected;
    /// The minimum area of a blob.
    LEAST_AREA: "", "", AREA;
    /// The pixels of the final mask.
    FINAL_FOREGROUND: "", "", AREA;
    /// The share of the frame that differs from the background, without shadows.
    DIFFERING_SHARE: "", "", Unit::PERCENT;
    /// The true objects of the frame.
    TRUE_OBJECTS: "", "", Unit::count("true object");
    /// The share of the boxes that match a true one.
    BOX_PRECISION: "Box precision", "", Unit::FINE, Role::Truth;
    /// The share of the true boxes that are matched.
    BOX_RECALL: "Box recall", "", Unit::FINE, Role::Truth;
    /// The harmonic mean of precision and recall of the boxes.
    BOX_F1: "Box F₁", "", Unit::FINE, Role::Truth;
    /// The share of the foreground pixels that are true.
    MASK_PRECISION: "Mask precision", "", Unit::FINE, Role::Truth;
    /// The share of the true foreground pixels that are found.
    MASK_RECALL: "Mask recall", "", Unit::FINE, Role::Truth;
    /// The harmonic mean of precision and recall of the pixels.
    MASK_F1: "Mask F₁", "", Unit::FINE, Role::Truth;
    /// The true pixels or objects that are not found.
    MISSES: "", "", AREA;
    /// The pixels or objects that are found and not true.
    FALSE_ALARMS: "", "", AREA;
    /// The blobs on the place of an object of the first frame that has left.
    GHOSTS: "", "", Unit::count("ghost");
}

crate::cases! { pub(crate) over value;
    AGAINST_MODEL: "Each pixel is compared with a background model; a large {compared} is foreground. Opening, closing and \
                    connected components turn the mask into blobs.",
    AGAINST_FRAME: "Each pixel is compared with the previous frame; a large {compared} is foreground. Opening, closing and \
                    connected components turn the mask into blobs.",
    REFERENCE: "Frame {frame} is the reference of frame {next_frame}.",
    FIRST_FRAME: "Frame {frame} initialises the background model. Objects in it will leave ghosts: false foreground until the \
                  model has learned the background behind them.",
    MEDIAN: "The median of frames spread evenly up to frame {last_frame} initialises the background model. An object that \
             covers a pixel in fewer than half of these frames leaves no ghost.",
    FOLLOWED: "The camera has moved. The median displacement of textured blocks since the first frame is {camera}. From its \
               position in the previous frame the model is shifted by {shift}",
    IN_WHOLE_PX: ", in whole px.",
    END: ".",
    BRIGHTER: "The exposure has changed: most pixels are {exposure_size} {reference|brighter} than the background",
    DARKER: "The exposure has changed: most pixels are {exposure_size} {reference|darker} than the background",
    BY_LEVEL: "({dark_change:bare} at level 64, {bright_change:bare} at level 192)",
    CORRECTED: ". The frame is corrected for it.",
    COMPARED: "{compared} at each pixel of frame {frame}. The heat map shows {shown}.",
    DECIDED: "{foreground} {candidate|of foreground} ({foreground_share} of the frame):",
    RULE: "|I − B| exceeds the threshold of {threshold}",
    ABOVE_NOISE: "exceeds {noise_sigmas} standard deviations of the noise, at least 8 gray levels",
    ABOVE_THRESHOLD: "exceeds the threshold of {threshold}",
    ANY_CHANNEL: ", in colour in any channel.",
    SHADOWS: "{rejected|Cast shadows:} {shadows} {rejected|of the foreground}, darker than the background, but of the same \
              colour, and not enclosed by foreground. They are removed.",
    DISPLACED: "{displaced} {rejected|of the foreground fit} the background of a pixel within shake = {shake}: the camera has \
                displaced it. They are removed.",
    OPENED: "Opening (erosion, then dilation with a {side}×{side} square) removed {removed} in regions narrower than the square.",
    AREA_OPENED: "Area opening removed {removed} in components of fewer than {least_component}, which are too small to be told \
                  from noise.",
    BOTH_OPENED: "Opening (erosion, then dilation with a {side}×{side} square) and area opening removed {removed} in regions \
                  narrower than the square and components of fewer than {least_component}.",
    CLOSED: "Closing (dilation, then erosion with a {side}×{side} square) filled {filled} in gaps narrower than the square.",
    LABELLED: "Labelling with {connectivity}-connectivity finds {components}.",
    KEPT: "{blobs} with at least {least_area}; {small_components} rejected as noise.",
    PIXEL: "{reference|Pixel} {pixel}",
    GRAY_LEVEL: ": gray level {gray_level}",
    COLOUR: ": colour {colour}",
    BACKGROUND: ", background {background}.",
    DIFFERENCE: "The difference {difference:bare}",
    LARGEST_DIFFERENCE: "The largest difference {difference:bare} in {channel}",
    EXCEEDS: "exceeds the threshold {threshold:bare}: foreground.",
    WITHIN: "is within the threshold {threshold:bare}: background.",
    IS_SHADOW: "It is a {rejected|cast shadow} and removed from the mask.",
    NO_SHADOW: "It is not a shadow.",
    IS_DISPLACED: "The background of a neighbour explains it: {rejected|displaced background}, removed from the mask.",
    NOT_DISPLACED: "The background of no neighbour explains it.",
    SHAKE_KEEPS: "Shake suppression does not change it.",
    OPENING_REMOVES: "Opening {rejected|removes} it.",
    OPENING_KEEPS: "Opening does not change it.",
    CLOSING_FILLS: "Closing {estimate|fills} it.",
    CLOSING_KEEPS: "Closing does not change it.",
    IN_COMPONENT: "It belongs to component {component}",
    TOO_SMALL: ", which is rejected: its area is below the minimum area.",
    IS_BLOB: ", which becomes a blob.",
    NO_COMPONENT: "It belongs to no component.",
    NO_BLOB: "It belongs to no blob.",
    UPDATE: "Update at {reference|pixel} {pixel}:",
    LARGEST_UPDATE: "Update at {reference|pixel} {pixel}, where the frame differs most:",
    MOVES_TO_LEVEL: "the background B moves from {background} to {background_after} toward the gray level {gray_level}",
    MOVES_TO_COLOUR: "the background B moves from {background} to {background_after} toward the colour {colour}",
    FRAME_RESULT: "Frame {frame}: {blobs}, {final_foreground} of foreground.",
    FRAME_SCORE: "Frame {frame}: {blobs} for {true_objects}; precision {box_precision}, recall {box_recall}, F₁ {box_f1} at IoU \
                  ≥ 0.5.",
    RUN_SCORE: "Run against the ground truth (IoU ≥ 0.5): precision {box_precision}, recall {box_recall}, F₁ {box_f1}.",
    UNLABELLED: "The ground truth labels no pixel of this frame, so its mask is not scored.",
    NO_FOREGROUND: "Neither the mask nor the ground truth has foreground in labelled pixels, so there is no F₁.",
    ALL_MASKS: "Pixels of all masks against the true foreground: precision {mask_precision}, recall {mask_recall}, F₁ {mask_f1};",
    ITS_MASK: "Its mask against the true foreground: precision {mask_precision}, recall {mask_recall}, F₁ {mask_f1};",
    NO_ERRORS: "no errors.",
    ERRORS: "{false_alarms} of false alarms, {misses} missed.",
    CAMERA_OR_LIGHT: "{differing_share} of the frame differs from the background: the camera moves, or the light has changed.",
    CAMERA_MOVED: "The background is displaced by {camera} since the first frame.",
    USE_MOTION: "This method needs a static camera and constant light. With a moving camera, compare the motion of objects with \
                 that of their surroundings (motion-compensated difference, optical flow, KLT, point trajectories).",
    GHOST: "1 ghost remains where an object of the first frame has left: initialise with the median, or let the model learn \
            faster.",
    GHOSTS: "{ghosts} remain where an object of the first frame has left: initialise with the median, or let the model learn \
             faster.",
    HIDDEN: "The masks agree with the truth; objects without a box may be mostly hidden, joined to another or smaller than the \
             minimum area.",
    SPLIT: "The masks agree with the truth; there are more blobs than objects, so objects may be split into parts: a larger \
            closing may join them.",
    JOINED: "The masks agree with the truth; there are fewer blobs than objects, so blobs may join objects that touch or hide \
             each other.",
    MISSHAPEN: "The masks agree with the truth; the wrong boxes are blobs that join or split objects, or shapes that overlap \
                their box by less than half.",
    MISSES: "Most errors are misses ({misses}): try a lower threshold, a smaller opening or a smaller minimum area.",
    FALSE_ALARMS: "Most errors are false alarms ({false_alarms}): try a higher threshold, a larger opening or a larger minimum \
                   area.",
    CAMERA_ALARMS: "Most errors are false alarms ({false_alarms}), and the camera moves: the background is displaced by \
                    {camera} since the first frame. A shift follows it only roughly, so edges of the background remain as \
                    foreground.",
    ONE_OF_EACH: "1 miss and 1 false alarm.",
    AS_MANY: "{misses:bare} misses and {false_alarms:bare} false alarms.",
}
