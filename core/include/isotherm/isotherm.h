/** @file
 * Includes all public headers of libisotherm. In the order in which data flows they are:
 *
 *  - frames and faces: camera.h, frame.h, capture.h, landmark.h, head_model.h, head_fit.h,
 *    extract.h, template.h, metric.h, index.h;
 *  - surfaces and heat: mesh.h, triangulate.h, stiffness_mass.h, eigenpairs.h, heat_kernel.h,
 *    isotherm_curve.h;
 *  - shapes in general: shape.h, mesh_file.h, signature.h, shape_method.h, correspondence.h,
 *    classifier.h;
 *  - vectors, rigid motions and faults: vec.h, fault.h.
 *
 * Rules that hold for every function:
 *
 *  - A function that can fail returns 0, or a negative number of errno.h.
 *  - The caller owns the object that a function `..._new` or `..._parse` returns, and frees it with
 *    the function `..._free` of the same name.
 *  - A pointer must not be NULL unless its description allows it.
 *  - Square brackets give the shape of an array; the slowest index comes first.
 *  - The end of a name gives its unit: _mm is a length in millimetres, _mm2 is a time of heat in
 *    square millimetres, and _ns is a time of a clock in nanoseconds.
 *  - The library opens no files and no devices, starts no threads, reads no clock, and prints
 *    nothing. Different objects may be used by different threads at the same time.
 *
 * Users of the installed library write `#include <isotherm/isotherm.h>`. */
#ifndef ISOTHERM_ISOTHERM_H
#define ISOTHERM_ISOTHERM_H

#include "isotherm/fault.h"
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
#include "isotherm/correspondence.h"
#include "isotherm/mesh_file.h"
#include "isotherm/shape.h"
#include "isotherm/shape_method.h"
#include "isotherm/signature.h"

#endif
