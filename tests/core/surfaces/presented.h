/* What somebody may hold or stand before a depth sensor, rendered and measured by a sensor model:
 * living heads of the shipped head model, masks of another size or with holes for eyes, sheets of
 * paper flat, rolled, wavy and folded, displays with holes. Everything is drawn from one stream of
 * random numbers, so that a seed names a scene. Failures fail the running cmocka test. */
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
    struct iso_frame *frame;              /* what the sensor reports, after presented_measure */
    struct iso_vec3 *shape_mm, *moved_mm; /* [model->n_vertices] the last head; scratch */
    double noise_scale;
    struct sim_random random;
};

/* An empty scene; the model must outlive it. */
struct presented *presented_new(const struct sim_sensor *sensor, const struct iso_head_model *model,
                                uint64_t seed);
void presented_free(struct presented *p);

/* A new head in shape_mm: identity and expression drawn from the model's own spread. */
void presented_draw_person(struct presented *p);

/* Attitude within +-10 degrees, place and distance where people stand before the sensor. */
struct iso_rigid presented_draw_pose(struct presented *p);

/* Empties the scene, then puts a wall 1.3 to 2.6 m away. */
void presented_clear(struct presented *p);

enum { PRESENTED_EYES_CUT = 1 };

/* The last head drawn, `size` times as large about its nose tip; flags: PRESENTED_EYES_CUT leaves
 * out what lies within the lids, so that what is drawn behind is seen. */
void presented_head(struct presented *p, const struct iso_rigid *pose, double size, unsigned flags);

/* The wearer behind the eyes of a mask: a plane surface at this distance behind it. */
void presented_behind(struct presented *p, const struct iso_rigid *pose, double behind_mm);

enum presented_bend { PRESENTED_FLAT, PRESENTED_ROLLED, PRESENTED_WAVY, PRESENTED_CREASED };

struct presented_sheet {
    double width_mm, height_mm;
    enum presented_bend bend;
    double radius_mm;  /* of the roll; of the wave at its crests */
    double crease_rad; /* of each of the creases */
    double axis_rad;   /* of the bend in the sheet: 0: about the vertical */
    bool oval;         /* cut out along the outline of a face */
    bool hand;         /* with a thumb before its edge and an arm behind it */
};

/* A sheet of random size and bend of that kind. */
struct presented_sheet presented_draw_sheet(struct presented *p, enum presented_bend bend);

/* Draws the sheet with its middle where a pose puts a nose tip, in the direction of the pose. */
void presented_sheet(struct presented *p, const struct presented_sheet *sheet,
                     const struct iso_rigid *pose);

/* Makes p->frame from the scene. */
void presented_measure(struct presented *p);

/* A display of that size: its glass, except the frame around it, loses this share of its
 * measurements in blotches. After presented_measure. */
void presented_blind(struct presented *p, const struct presented_sheet *sheet,
                     const struct iso_rigid *pose, double bezel_mm, double lost_share);

#endif
