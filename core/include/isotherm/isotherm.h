/* The whole of libisotherm, in the order the data flows. Users of the installed library write
 * `#include <isotherm/isotherm.h>`. */
#ifndef ISOTHERM_ISOTHERM_H
#define ISOTHERM_ISOTHERM_H

#include "core/surface/grid.h"
#include "isotherm/camera.h"
#include "isotherm/frame.h"
#include "isotherm/head_model.h"
#include "isotherm/landmark.h"
#include "isotherm/mesh.h"
#include "isotherm/triangulate.h"

#include "core/heat/grid/heat_grid.h"
#include "core/isotherm/grid_isotherm.h"
#include "isotherm/eigenpairs.h"
#include "isotherm/heat_kernel.h"
#include "isotherm/isotherm_curve.h"
#include "isotherm/stiffness_mass.h"

#include "core/shape/classify/confusion.h"
#include "core/shape/classify/retrieval.h"
#include "core/shape/describe/critical_points.h"
#include "core/shape/describe/heat_signature.h"
#include "core/shape/describe/scale_invariant.h"
#include "isotherm/classifier.h"
#include "isotherm/shape.h"
#include "isotherm/shape_method.h"

#include "core/match/cohort.h"
#include "core/match/distance.h"
#include "core/match/rerank.h"
#include "core/match/search.h"
#include "core/registration/icp.h"
#include "isotherm/index.h"
#include "isotherm/metric.h"
#include "isotherm/template.h"

#include "isotherm/extract.h"

#endif
