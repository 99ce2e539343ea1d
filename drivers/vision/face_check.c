#include "drivers/vision/face_check.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/file/file.h"
#include "drivers/vision/face_chip.h"
#include "drivers/vision/face_detector.h"

enum { CASCADE_BYTES_MAX = 1 << 25 }; /* OpenCV's largest cascade has 2.6 MiB */

/* The cascade finds faces as squares 155 to 195 mm wide. */
static const double side_min_mm = 120.0, side_max_mm = 220.0;
/* The middle of the cascade's square is this far above the mean of the twelve landmarks. */
static const double above_mm = 9.0;
/* The largest accepted offset. 10.3 mm is the largest that was measured on correctly fitted
 * faces. */
static const double offset_max_mm = 18.0;

/* If the head is turned further, half of the picture is a guess. */
static const double turned_cosine = 0.77; /* 40 degrees */
static const double measured_min = 0.6;
static const double level_min = 0.012; /* 3 of 255 */
static const double saturated_max = 0.25;
static const double grain_max = 0.12;

struct iso_face_check {
    struct iso_face_detector *detector;
    struct iso_face_chip chip;
};

const char *iso_face_seen_name(enum iso_face_seen seen)
{
    static const char *const names[ISO_FACE_SEEN] = {
        "not-checked", "no-intensity", "turned",    "hidden",    "dark",
        "glaring",     "grainy",       "confirmed", "elsewhere", "absent",
    };
    return (unsigned)seen < ISO_FACE_SEEN ? names[seen] : NULL;
}

bool iso_face_seen_disagrees(enum iso_face_seen seen)
{
    return seen == ISO_FACE_ELSEWHERE || seen == ISO_FACE_ABSENT;
}

int iso_face_check_new(const char *cascade_path, struct iso_face_check **out,
                       struct iso_fault *fault)
{
    int error = iso_face_detector_load(fault);
    if (error) {
        return error;
    }
    const char *path = *cascade_path ? cascade_path : iso_face_detector_cascade();
    if (!*path) {
        return iso_fault_set_code(fault, ISO_FAULT_FILE_MISSING, -ENOENT,
                                  "face check: built without a cascade; name one");
    }
    error = iso_file_check(path, CASCADE_BYTES_MAX, fault);
    if (error) {
        return error;
    }
    struct iso_face_check *check = calloc(1, sizeof *check);
    if (!check) {
        return iso_fault_set(fault, -ENOMEM, "face check: out of memory");
    }
    error = iso_face_detector_new(path, &check->detector, fault);
    if (error) {
        free(check);
        return error;
    }
    *out = check;
    return 0;
}

void iso_face_check_free(struct iso_face_check *check)
{
    if (check) {
        iso_face_detector_free(check->detector);
        explicit_bzero(&check->chip, sizeof check->chip);
        free(check);
    }
}

/* Whether the picture can be relied on. */
static enum iso_face_seen judge_picture(const struct iso_face_chip *chip)
{
    if (chip->measured < measured_min) {
        return ISO_FACE_HIDDEN;
    }
    if (chip->level < level_min) {
        return ISO_FACE_DARK;
    }
    if (chip->saturated > saturated_max) {
        return ISO_FACE_GLARING;
    }
    return chip->grain > grain_max ? ISO_FACE_GRAINY : ISO_FACE_NOT_CHECKED;
}

/* The expected middle of the cascade's square, in the face frame. */
static struct iso_vec3 expected_place(const struct iso_rigid *camera_from_face,
                                      const struct iso_vec3 landmark_mm[ISO_LANDMARKS])
{
    const struct iso_rigid face_from_camera = iso_rigid_inverse(camera_from_face);
    struct iso_vec3 sum = {0.0, 0.0, 0.0};
    for (int i = 0; i < ISO_LANDMARKS; i++) {
        sum = iso_add(sum, iso_rigid_apply(&face_from_camera, landmark_mm[i]));
    }
    return iso_vec3(sum.x / ISO_LANDMARKS, sum.y / ISO_LANDMARKS + above_mm, 0.0);
}

static void compare(const struct iso_face_box *box, struct iso_vec3 expected,
                    struct iso_face_checked *checked)
{
    if (box->votes == 0) {
        checked->seen = ISO_FACE_ABSENT;
        return;
    }
    const struct iso_vec3 seen = iso_face_chip_place(box->column_px, box->row_px);
    checked->offset_mm = hypot(seen.x - expected.x, seen.y - expected.y);
    checked->side_mm = box->side_px * ISO_FACE_CHIP_PITCH_MM;
    checked->votes = box->votes;
    checked->seen = checked->offset_mm <= offset_max_mm ? ISO_FACE_CONFIRMED : ISO_FACE_ELSEWHERE;
}

int iso_face_check_run(struct iso_face_check *check, const struct iso_frame *frame,
                       const struct iso_rigid *camera_from_face,
                       const struct iso_vec3 landmark_mm[ISO_LANDMARKS],
                       struct iso_face_checked *out)
{
    struct iso_face_checked checked = {.seen = ISO_FACE_NOT_CHECKED};
    if (!frame->intensity) {
        checked.seen = ISO_FACE_NO_INTENSITY;
    } else if (-camera_from_face->rotation.m[2][2] < turned_cosine) {
        checked.seen = ISO_FACE_TURNED;
    } else if (iso_face_chip_draw(&check->chip, frame, camera_from_face)) {
        checked.seen = ISO_FACE_HIDDEN;
    } else {
        checked.seen = judge_picture(&check->chip);
    }
    if (checked.seen == ISO_FACE_NOT_CHECKED) {
        struct iso_face_box box;
        const int error = iso_face_detector_find(check->detector, check->chip.picture,
                                                 ISO_FACE_CHIP_SIDE, ISO_FACE_CHIP_SIDE,
                                                 (int)(side_min_mm / ISO_FACE_CHIP_PITCH_MM),
                                                 (int)(side_max_mm / ISO_FACE_CHIP_PITCH_MM), &box);
        if (error) {
            return error;
        }
        compare(&box, expected_place(camera_from_face, landmark_mm), &checked);
    }
    *out = checked;
    return 0;
}
