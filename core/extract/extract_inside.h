/* What the project itself looks at inside an extractor, besides what isotherm/extract.h offers to
 * everybody. */
#ifndef ISO_CORE_EXTRACT_EXTRACT_INSIDE_H
#define ISO_CORE_EXTRACT_EXTRACT_INSIDE_H

#include "core/landmark/shape_fit.h"
#include "core/surface/face_patch.h"
#include "isotherm/extract.h"

/* The head that was fitted in the last run with `fitted`: its triangles are the head model's. */
struct iso_shape_residuals iso_extractor_fit(const struct iso_extractor *extractor);

/* The grid that mesh was made of: it knows what was measured and what filled in. */
const struct iso_face_patch *iso_extractor_patch(const struct iso_extractor *extractor);

#endif
