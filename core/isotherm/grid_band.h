/* The triangles of a grid that a level may cut, and the level that encloses an area. Internal to
 * core/isotherm. */
#ifndef ISO_CORE_ISOTHERM_GRID_BAND_H
#define ISO_CORE_ISOTHERM_GRID_BAND_H

#include "core/surface/grid.h"

/* A triangle, named by the plane index of its cell and the corner that it leaves out (cell.h). */
struct iso__grid_triangle {
    int32_t cell;
    uint8_t left_out;
    float area_mm2;
    float heat[3]; /* at its corners, in their order */
};

/* A key stands for a range of heat: it is the first 12 bits of a float, so that each octave is
 * divided into 8 ranges. Heat is not negative, so that there are 2048 keys. */
enum { ISO__GRID_KEYS = 2048, ISO__GRID_KEY_SHIFT = 20 };

struct iso__grid_band {
    double low, high; /* `triangle` has every triangle that a level between these two cuts */
    int32_t n;        /* triangles in the band */
    struct iso__grid_triangle *triangle; /* [n], in the order of a mesh's triangles */
    double above_mm2;                    /* area of the triangles that lie wholly above `high` */
    float key_mm2[ISO__GRID_KEYS];       /* area of each key; all zero except during a search */
};

/* Allocates room for all triangles of a grid. *band is all zero before. -ENOMEM, after which
 * iso__grid_band_done is still allowed. */
int iso__grid_band_init(struct iso__grid_band *band, const struct iso_grid *grid)
    __attribute__((warn_unused_result));

/* Releases what it holds. */
void iso__grid_band_done(struct iso__grid_band *band);

/* Finds the level with the area pi radius^2 above it in the field's window, and collects the
 * triangles of the band about it. -ERANGE as for iso_grid_tracer_run. */
int iso__grid_band_find(struct iso__grid_band *band, const struct iso_grid *grid,
                        const struct iso_grid_field *field, double radius_mm, double *level)
    __attribute__((warn_unused_result));

#endif
