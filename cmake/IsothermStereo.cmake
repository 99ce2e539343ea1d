# The option ISOTHERM_STEREO: depth from two cameras, and their calibration, by OpenCV. On where its narrow packages and a C++
# compiler are found. Debian's narrow packages have neither a CMake nor a pkg-config file. Makes the target isotherm-opencv-stereo.
if(CMAKE_C_COMPILER_ID STREQUAL "Clang" AND NOT CMAKE_CXX_COMPILER AND NOT DEFINED ENV{CXX})
  set(CMAKE_CXX_COMPILER clang++) # the sanitizers of two compilers do not mix
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
  # SYSTEM: our warnings are for our sources.
  target_include_directories(isotherm-opencv-stereo SYSTEM INTERFACE ${OPENCV_STEREO_INCLUDE_DIR})
  target_link_libraries(isotherm-opencv-stereo INTERFACE
    ${OPENCV_STEREO_calib3d} ${OPENCV_STEREO_imgproc} ${OPENCV_STEREO_core})
endif()
