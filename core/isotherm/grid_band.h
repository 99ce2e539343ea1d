/* The triangles of a grid that a level may cut, and the level that encloses an area. Internal to
 * core/isotherm. */
#ifndef ISO_CORE_ISOTHERM_GRID_BAND_H
#define ISO_CORE_ISOTHERM_GRID_BAND_H

#include "core/surface/grid.h"

/* A triangle by its cell's plane index and the corner that it leaves out. */
struct iso__grid_triangle {
    int32_t cell;
    uint8_t left_out;
    float area_mm2;
    float heat[3]; /* at its corners, in their order */
};

/* Heat in eighths of an octave: the first 12 bits of a float. */
enum { ISO__GRID_KEYS = 2048, ISO__GRID_KEY_SHIFT = 20 };

struct iso__grid_band {
    double low, high; /* all triangles that a level between them cuts are here: */
    int32_t n;        /* how many */
    struct iso__grid_triangle *triangle; /* in the order of a mesh's triangles */
    double above_mm2;                    /* area of those that lie above `high` altogether */
    float key_mm2[ISO__GRID_KEYS];       /* zero but while the band is made */
};

/* Allocates room for all triangles of a grid. -ENOMEM; iso__grid_band_done accepts the rest of a
 * failed one. */
int iso__grid_band_init(struct iso__grid_band *band, const struct iso_grid *grid)
    __attribute__((warn_unused_result));

/* Releases what it holds. */
void iso__grid_band_done(struct iso__grid_band *band);

/* Finds the level with the area pi radius^2 above it in the field's window, and the band about it.
 * -ERANGE as iso_grid_tracer_run. */
int iso__grid_band_find(struct iso__grid_band *band, const struct iso_grid *grid,
                        const struct iso_grid_field *field, double radius_mm, double *level)
    __attribute__((warn_unused_result));

#endif
