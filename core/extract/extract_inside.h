/* Access to the inside of an extractor for other parts of the project. It is not public, unlike
 * isotherm/extract.h. */
#ifndef ISO_CORE_EXTRACT_EXTRACT_INSIDE_H
#define ISO_CORE_EXTRACT_EXTRACT_INSIDE_H

#include "core/landmark/shape_fit.h"
#include "core/surface/face_patch.h"
#include "isotherm/extract.h"

/* The head that was fitted in the last run with `fitted`. Its triangles are the head model's. It
 * belongs to the extractor and is valid until the next run. */
struct iso_shape_residuals iso_extractor_fit(const struct iso_extractor *extractor);

/* The face patch of the last run that reached ISO_STAGE_PATCH. It knows what was measured and what
 * was filled in. It belongs to the extractor. */
const struct iso_face_patch *iso_extractor_patch(const struct iso_extractor *extractor);

#endif
