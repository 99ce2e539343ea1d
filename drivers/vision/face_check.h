/* A second opinion on a face that was found in depth: it checks whether the infrared or grey image
 * of the same frame shows a face where the fitted landmarks are.
 *
 * The face is drawn as seen from straight ahead (face_chip.h), a cascade looks for a frontal face
 * in it (face_detector.h), and the middle of the face that it finds is compared with the landmarks.
 * The check can confirm or contradict the landmarks; it never moves one.
 *
 * Measured on 370 frames of 7 real people before a Kinect v2, every pose and expression: the
 * cascade's middle is 3 mm (median) and at most 10 mm from where it should be; none is contradicted
 * (0 of 370; 95 % interval 0 to 1.0 % if frames were independent; of people, 0 of 7). Landmarks
 * that are moved aside by 20, 25, 30 mm are contradicted in 76, 99, 100 % of 1480 cases each. An
 * evenly bright image, as of a print whose ink is transparent to infrared, is always contradicted.
 * The check does not notice landmarks that are less than 15 mm off, a print whose ink shows in
 * infrared, and a bust without markings (its shading alone looks like a face). The depths must
 * reveal those. tests/sim/lab/test_face_check_kinect2.c and _rendered.c repeat this.
 *
 * Other methods were tried and not used: eye cascades (they miss one eye or both in more than half
 * of these frames); the contrast of eyes, brows and cheeks at the landmarks themselves (it notices
 * 29 % of the landmarks that are 20 mm off); pictures made without the measured surface (12 mm off
 * in the median); pictures with the shading divided out (they miss one face of 370 and reveal
 * hardly any bust). */
#ifndef ISO_DRIVERS_VISION_FACE_CHECK_H
#define ISO_DRIVERS_VISION_FACE_CHECK_H

#include "core/base/fault.h"
#include "isotherm/frame.h"
#include "isotherm/landmark.h"

/* The result of the image check. */
enum iso_face_seen {
    ISO_FACE_NOT_CHECKED = 0,
    /* The image cannot be judged. */
    ISO_FACE_NO_INTENSITY, /* the frame has no image */
    ISO_FACE_TURNED,       /* turned too far for a frontal view */
    ISO_FACE_HIDDEN,       /* too little of the face's middle is measured and in the image */
    ISO_FACE_DARK,
    ISO_FACE_GLARING, /* overexposed */
    ISO_FACE_GRAINY,  /* noise, or the dots of a projector */
    /* The image confirms the face. */
    ISO_FACE_CONFIRMED,
    /* The image contradicts. */
    ISO_FACE_ELSEWHERE, /* a face is seen at another place */
    ISO_FACE_ABSENT,    /* no face is seen */
    ISO_FACE_SEEN
};

/* "not-checked", "no-intensity", "turned", "hidden", "dark", "glaring", "grainy", "confirmed",
 * "elsewhere", "absent"; NULL outside. */
const char *iso_face_seen_name(enum iso_face_seen seen);

/* Whether the image contradicts the landmarks: ELSEWHERE or ABSENT. */
bool iso_face_seen_disagrees(enum iso_face_seen seen);

struct iso_face_checked {
    enum iso_face_seen seen;
    /* Distance of the face that is seen from the expected place; 0: none is seen. */
    double offset_mm;
    double side_mm; /* of the square in which it is seen; 0 if none is seen */
    int votes;      /* windows of the cascade that agreed */
};

struct iso_face_check;

/* Makes a check with the cascade of a file; "" means the cascade that the build found. The errors
 * of iso_face_detector_new and of iso_file_check; -ENOENT also if the build found no cascade. A
 * check is used by one thread at a time. */
int iso_face_check_new(const char *cascade_path, struct iso_face_check **out,
                       struct iso_fault *fault) __attribute__((warn_unused_result));

/* Wipes and frees it and what it holds. NULL is accepted. */
void iso_face_check_free(struct iso_face_check *check);

/* Checks a frame that iso_frame_check accepts, with the pose of the face in it and the twelve
 * landmarks in the camera frame, millimetres. Errors of iso_face_detector_find. */
int iso_face_check_run(struct iso_face_check *check, const struct iso_frame *frame,
                       const struct iso_rigid *camera_from_face,
                       const struct iso_vec3 landmark_mm[ISO_LANDMARKS],
                       struct iso_face_checked *out) __attribute__((warn_unused_result));

#endif
