/* The whole of libisotherm, in the order the data flows. Users of the installed library write
 * `#include <isotherm.h>`. */
#ifndef ISO_CORE_ISOTHERM_H
#define ISO_CORE_ISOTHERM_H

#include "core/frame/camera.h"
#include "core/frame/frame.h"
#include "core/landmark/head_model.h"
#include "core/landmark/landmark.h"
#include "core/surface/grid.h"
#include "core/surface/mesh.h"
#include "core/surface/triangulate.h"

#include "core/heat/eigenpairs.h"
#include "core/heat/grid/heat_grid.h"
#include "core/heat/heat_kernel.h"
#include "core/heat/stiffness_mass.h"
#include "core/isotherm/grid_isotherm.h"
#include "core/isotherm/isotherm.h"

#include "core/shape/classify/classifier.h"
#include "core/shape/classify/confusion.h"
#include "core/shape/classify/retrieval.h"
#include "core/shape/describe/critical_points.h"
#include "core/shape/describe/heat_signature.h"
#include "core/shape/describe/method.h"
#include "core/shape/describe/scale_invariant.h"
#include "core/shape/describe/shape.h"

#include "core/match/cohort.h"
#include "core/match/distance.h"
#include "core/match/index.h"
#include "core/match/metric.h"
#include "core/match/rerank.h"
#include "core/match/search.h"
#include "core/match/template.h"
#include "core/registration/icp.h"

#include "core/extract/extract.h"

#endif
