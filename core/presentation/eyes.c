#include "core/presentation/eyes.h"

#include "core/landmark/meeting.h"

enum { CORNERS = 6, RIGHT_EYE = 36, LEFT_EYE = 42, RINGS = 2, PLACES = CORNERS * RINGS + 1 };

/* The rings of places within and about an eye: the factors by which its contour is scaled about its
 * middle. */
static const double within[RINGS] = {0.3, 0.6}, about[RINGS] = {2.3, 2.9};
/* A place about the lids counts as part of the face if it lies this near to the fitted head. */
static const double on_face_mm = 8.0;

static double median(double *values, int n)
{
    for (int i = 1; i < n; i++) {
        const double value = values[i];
        int at = i;
        for (; at > 0 && values[at - 1] > value; at--) {
            values[at] = values[at - 1];
        }
        values[at] = value;
    }
    return n > 0 ? values[n / 2] : 0.0;
}

/* How far behind a place of the face frame the surface lies, along the face's axis. */
static enum iso_meeting behind(const struct iso_frame *frame, const struct iso_rigid *pose,
                               struct iso_vec3 place, double *behind_mm)
{
    const struct iso_vec3 out = iso_mat3_apply(&pose->rotation, iso_vec3(0, 0, 1));
    return iso_meet(frame, iso_rigid_apply(pose, place), out, behind_mm);
}

static struct iso_eye measure(const struct iso_frame *frame, const struct iso_rigid *pose,
                              const struct iso_vec3 contour[CORNERS])
{
    struct iso_eye eye = {0};
    struct iso_vec3 middle = {0, 0, 0};
    double ring[CORNERS * RINGS], inner[PLACES], r;
    int n_ring = 0, n_inner = 0, holes = 0, far_behind = 0;
    for (int k = 0; k < CORNERS; k++) {
        middle = iso_madd(middle, 1.0 / CORNERS, contour[k]);
    }
    for (int i = 0; i < CORNERS * RINGS; i++) {
        const struct iso_vec3 arm = iso_sub(contour[i % CORNERS], middle);
        if (behind(frame, pose, iso_madd(middle, about[i / CORNERS], arm), &r) ==
                ISO_MEETING_MEASURED &&
            fabs(r) < on_face_mm) {
            ring[n_ring++] = r;
        }
    }
    eye.around_share = (double)n_ring / (CORNERS * RINGS);
    const double lids_mm = median(ring, n_ring);
    for (int i = 0; i < PLACES; i++) {
        const struct iso_vec3 arm = i == 0 ? iso_vec3(0, 0, 0)
                                           : iso_scale(within[(i - 1) / CORNERS],
                                                       iso_sub(contour[(i - 1) % CORNERS], middle));
        if (behind(frame, pose, iso_add(middle, arm), &r) == ISO_MEETING_MEASURED) {
            inner[n_inner++] = r - lids_mm;
            far_behind += r - lids_mm > ISO_EYE_BEHIND_MM;
        } else {
            holes++;
        }
    }
    eye.behind_share = (double)far_behind / PLACES;
    eye.hole_share = (double)holes / PLACES;
    eye.depth_mm = median(inner, n_inner);
    return eye;
}

void iso_eyes_measure(const struct iso_frame *frame, const struct iso_shape_fit *fit,
                      struct iso_eye eyes[ISO_EYES])
{
    const struct iso_rigid *pose = &fit->pose.camera_from_face;
    eyes[ISO_EYE_R] = measure(frame, pose, &fit->ibug_mm[RIGHT_EYE]);
    eyes[ISO_EYE_L] = measure(frame, pose, &fit->ibug_mm[LEFT_EYE]);
}
