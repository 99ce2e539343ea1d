# Options ISOTHERM_LIBSVM and ISOTHERM_OPENCV_ML: classifiers of other libraries for the evaluation of shapes (sim/shapes/learn). They
# are on if the libraries are found. Include this file after IsothermOpenCV, which finds the C++ compiler.
find_path(LIBSVM_INCLUDE_DIR libsvm/svm.h)
find_library(LIBSVM_LIBRARY svm)
find_path(OPENCV_ML_INCLUDE_DIR opencv2/ml.hpp PATH_SUFFIXES opencv4)
find_library(OPENCV_ML opencv_ml)
mark_as_advanced(LIBSVM_INCLUDE_DIR LIBSVM_LIBRARY OPENCV_ML_INCLUDE_DIR OPENCV_ML)

set(found OFF)
if(LIBSVM_INCLUDE_DIR AND LIBSVM_LIBRARY)
  set(found ON)
endif()
option(ISOTHERM_LIBSVM "Support vector machines (libsvm)" ${found})
set(found OFF)
if(CMAKE_CXX_COMPILER AND OPENCV_ML_INCLUDE_DIR AND OPENCV_ML AND OPENCV_CORE)
  set(found ON)
endif()
option(ISOTHERM_OPENCV_ML "Decision trees (OpenCV's ml)" ${found})
