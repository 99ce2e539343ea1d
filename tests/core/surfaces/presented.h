/* Objects that somebody may present to a depth sensor, rendered and measured by a sensor model:
 * living heads of the shipped head model, masks of another size or with holes for the eyes, sheets
 * of paper (flat, rolled, wavy and folded), and displays with holes. All random numbers come from
 * one stream, so that a seed determines a scene. A failure fails the running cmocka test. */
#ifndef TESTS_CORE_SURFACES_PRESENTED_H
#define TESTS_CORE_SURFACES_PRESENTED_H

#include <stdbool.h>

#include "isotherm/head_model.h"
#include "sim/base/random.h"
#include "sim/world/sensor/sensor.h"

struct presented {
    const struct sim_sensor *sensor;
    const struct iso_head_model *model;
    struct sim_view *view;
    struct sim_sensor_workspace *workspace;
    struct iso_frame *frame; /* the frame of the sensor; presented_measure makes it */
    struct iso_vec3 *shape_mm,
        *moved_mm; /* [model->n_vertices] the head that was drawn last; scratch memory */
    double noise_scale;
    struct sim_random random;
};

/* Makes a scene. The sensor and the model must outlive it. */
struct presented *presented_new(const struct sim_sensor *sensor, const struct iso_head_model *model,
                                uint64_t seed);
/* NULL is accepted. */
void presented_free(struct presented *p);

/* Draws a new head into shape_mm. Identity and expression come from the model's own distribution.
 */
void presented_draw_person(struct presented *p);

/* Draws a pose: an attitude within +-10 degrees, and a place and a distance at which people stand
 * before the sensor. */
struct iso_rigid presented_draw_pose(struct presented *p);

/* Empties the scene, then puts a wall 1.3 to 2.6 m away. */
void presented_clear(struct presented *p);

enum { PRESENTED_EYES_CUT = 1 };

/* Adds the head that was drawn last, scaled by `size` about its nose tip. flags: PRESENTED_EYES_CUT
 * leaves out the surface between the eyelids, so that objects behind it are visible. */
void presented_head(struct presented *p, const struct iso_rigid *pose, double size, unsigned flags);

/* Adds the person who wears a mask, as seen through its eye holes: a plane surface at this distance
 * behind the mask. */
void presented_behind(struct presented *p, const struct iso_rigid *pose, double behind_mm);

enum presented_bend { PRESENTED_FLAT, PRESENTED_ROLLED, PRESENTED_WAVY, PRESENTED_CREASED };

struct presented_sheet {
    double width_mm, height_mm;
    enum presented_bend bend;
    double radius_mm;  /* radius of the roll, or of the wave at its crests */
    double crease_rad; /* angle of each crease */
    double axis_rad;   /* direction of the axis of the bend in the sheet; 0: vertical */
    bool oval;         /* the sheet is cut out along the outline of a face */
    bool hand;         /* a hand holds it: a thumb is before its edge and an arm behind it */
};

/* Draws a sheet of this kind with random size and bend. */
struct presented_sheet presented_draw_sheet(struct presented *p, enum presented_bend bend);

/* Adds the sheet. Its centre is where the pose puts a nose tip, and it faces in the direction of
 * the pose. */
void presented_sheet(struct presented *p, const struct presented_sheet *sheet,
                     const struct iso_rigid *pose);

/* Makes p->frame from the scene. */
void presented_measure(struct presented *p);

/* Simulates a display of that size: its glass, without a frame of bezel_mm around it, loses the
 * share lost_share of its measurements in blotches. Call it after presented_measure. */
void presented_blind(struct presented *p, const struct presented_sheet *sheet,
                     const struct iso_rigid *pose, double bezel_mm, double lost_share);

#endif
