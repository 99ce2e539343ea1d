/* Looks at every mesh and every cloud of a corpus before the work begins. */
#ifndef SIM_SHAPES_DESCRIBE_CORPUS_H
#define SIM_SHAPES_DESCRIBE_CORPUS_H

#include <stdio.h>

#include "sim/shapes/describe/source.h"
#include "sim/shapes/make/manifest.h"

struct sim_corpus_look {
    const char *directory;
    int neighbours; /* of each point of a cloud; 0: ISO_CLOUD_NEIGHBOURS */
    bool mend;      /* accept meshes that lose over 1 % of their area, or clouds of their points */
    bool strict;    /* fail at the first mesh that cannot be used */
    bool colours_needed;
    int threads;
};

/* Reads and mends every mesh of a manifest. Those that cannot be used are named on standard error
 * and removed from the manifest, or with `strict` the first one is the fault. Writes
 * OUT/meshes.csv: file, class, state, vertices and triangles of the part that is described, parts,
 * vertices and share of the area left out, and what was mended. A cloud has points instead of
 * vertices, no triangles, and the share of its points instead of the area. `coloured` receives how
 * many of the remaining meshes have colours. -ENODATA if no mesh is left; errors of the first mesh
 * that cannot be used if none can, or with `strict`; errors of writing; each with a fault. */
int sim_corpus_look(const struct sim_corpus_look *how, struct sim_shape_manifest *manifest,
                    const char *out, int32_t *coloured, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
