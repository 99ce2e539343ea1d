/* The whole of libisotherm, in the order the data flows. Users of the installed library write
 * `#include <isotherm/isotherm.h>`. */
#ifndef ISOTHERM_ISOTHERM_H
#define ISOTHERM_ISOTHERM_H

#include "isotherm/vec.h"

#include "isotherm/camera.h"
#include "isotherm/capture.h"
#include "isotherm/extract.h"
#include "isotherm/frame.h"
#include "isotherm/head_fit.h"
#include "isotherm/head_model.h"
#include "isotherm/index.h"
#include "isotherm/landmark.h"
#include "isotherm/metric.h"
#include "isotherm/template.h"

#include "isotherm/eigenpairs.h"
#include "isotherm/heat_kernel.h"
#include "isotherm/isotherm_curve.h"
#include "isotherm/mesh.h"
#include "isotherm/stiffness_mass.h"
#include "isotherm/triangulate.h"

#include "isotherm/classifier.h"
#include "isotherm/shape.h"
#include "isotherm/shape_method.h"

#endif
