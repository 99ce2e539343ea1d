/* The triangles of a grid that a level may cut, and the level that encloses an area. Internal to
 * core/isotherm. */
#ifndef ISO_CORE_ISOTHERM_GRID_BAND_H
#define ISO_CORE_ISOTHERM_GRID_BAND_H

#include "core/isotherm/level_search.h"
#include "core/surface/grid.h"

/* A triangle, named by the plane index of its cell and the corner that it leaves out (cell.h). */
struct iso__grid_triangle {
    int32_t cell;
    uint8_t left_out;
    float area_mm2;
    struct iso__corner_heat heat;
};

/* A key stands for a range of heat: it is the first 12 bits of a float, so that each octave is
 * divided into 8 ranges. Heat is not negative, so that there are 2048 keys. */
enum { ISO__GRID_KEYS = 2048, ISO__GRID_KEY_SHIFT = 20 };

/* Cells of a row: from `first` to the one before `end`, columns of the plane. */
struct iso__grid_run {
    int first, end;
};

struct iso__grid_band {
    /* the field, and the area of its vertices by their key */
    const struct iso_grid *grid;
    const struct iso_grid_field *field;
    uint32_t least, most;          /* keys; most is 0 if no vertex has heat */
    float key_mm2[ISO__GRID_KEYS]; /* 0 below `least` and above `most` */

    /* Each row has a run of columns. A cell outside of it is colder than run_heat at its four
     * corners. */
    struct iso__grid_run *run; /* [grid->height] */
    float run_heat;

    /* the band of the last search */
    double low, high; /* `triangle` has every triangle that a level between these two cuts */
    int32_t n;        /* triangles in the band */
    struct iso__grid_triangle *triangle; /* [n], in the order of a mesh's triangles */
    double above_mm2;                    /* area of the triangles that lie wholly above `high` */
};

/* Allocates room for all triangles of a grid. *band is all zero before. -ENOMEM, after which
 * iso__grid_band_done is still allowed. */
int iso__grid_band_init(struct iso__grid_band *band, const struct iso_grid *grid)
    __attribute__((warn_unused_result));

/* Releases what it holds. */
void iso__grid_band_done(struct iso__grid_band *band);

/* Takes a field to search. Grid and field must last until the last search. */
void iso__grid_band_begin(struct iso__grid_band *band, const struct iso_grid *grid,
                          const struct iso_grid_field *field);

/* Finds the level with the area pi radius^2 above it in the field's window, and collects the
 * triangles of the band about it. Searches from the largest radius down take least time. -ERANGE as
 * for iso_grid_tracer_run. */
int iso__grid_band_find(struct iso__grid_band *band, double radius_mm, double *level)
    __attribute__((warn_unused_result));

#endif
