# The option ISOTHERM_STEREO: depth from two cameras, and their calibration, by OpenCV. It is on if OpenCV's core, imgproc and calib3d and
# a C++ compiler are found. The search is by file names, because Debian's packages of single OpenCV libraries have neither a CMake nor a
# pkg-config file. Makes the target isotherm-opencv-stereo.
if(CMAKE_C_COMPILER_ID STREQUAL "Clang" AND NOT CMAKE_CXX_COMPILER AND NOT DEFINED ENV{CXX})
  set(CMAKE_CXX_COMPILER clang++) # sanitizers of two compilers cannot be linked into one program
endif()
include(CheckLanguage)
check_language(CXX)
find_path(OPENCV_STEREO_INCLUDE_DIR opencv2/calib3d.hpp PATH_SUFFIXES opencv4)
foreach(part core imgproc calib3d)
  find_library(OPENCV_STEREO_${part} opencv_${part})
  mark_as_advanced(OPENCV_STEREO_${part})
endforeach()
mark_as_advanced(OPENCV_STEREO_INCLUDE_DIR)

set(found OFF)
if(CMAKE_CXX_COMPILER AND OPENCV_STEREO_INCLUDE_DIR AND OPENCV_STEREO_core AND OPENCV_STEREO_imgproc AND OPENCV_STEREO_calib3d)
  set(found ON)
endif()
option(ISOTHERM_STEREO "Depth from two cameras (OpenCV's core, imgproc and calib3d)" ${found})

if(ISOTHERM_STEREO)
  if(NOT found)
    message(FATAL_ERROR "ISOTHERM_STEREO needs a C++ compiler and libopencv-core-dev, -imgproc-dev, -calib3d-dev")
  endif()
  set(CMAKE_CXX_STANDARD 17)
  set(CMAKE_CXX_STANDARD_REQUIRED ON)
  enable_language(CXX)
  add_library(isotherm-opencv-stereo INTERFACE)
  # SYSTEM: the project's warnings do not apply to OpenCV's headers.
  target_include_directories(isotherm-opencv-stereo SYSTEM INTERFACE ${OPENCV_STEREO_INCLUDE_DIR})
  target_link_libraries(isotherm-opencv-stereo INTERFACE
    ${OPENCV_STEREO_calib3d} ${OPENCV_STEREO_imgproc} ${OPENCV_STEREO_core})
endif()
