#include "drivers/stereo/board_opencv.h"

#include <algorithm>
#include <vector>

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "drivers/stereo/opencv_guard.hh"

namespace
{

using problem = iso_board_opencv_problem;
using solution = iso_board_opencv_solution;

/* Searches a small, smooth copy first, because noise would look like thousands of squares. Then
 * refines the corners in the original picture. */
bool find(const cv::Mat &image, const cv::Size &shape, float (*out)[2])
{
    std::vector<cv::Point2f> corners;
    double factor = std::max(1.0, image.cols / 640.0);
    cv::Mat small;
    cv::GaussianBlur(image, small, cv::Size(0, 0), 0.6 * factor);
    cv::resize(small, small, cv::Size(), 1.0 / factor, 1.0 / factor, cv::INTER_AREA);
    int flags = cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE |
                cv::CALIB_CB_FAST_CHECK;
    if (!cv::findChessboardCorners(small, shape, corners, flags)) {
        return false;
    }
    for (cv::Point2f &corner : corners) {
        /* In both pictures, pixel centres have whole numbers as coordinates. */
        corner = cv::Point2f((float)((corner.x + 0.5) * factor - 0.5),
                             (float)((corner.y + 0.5) * factor - 0.5));
    }
    /* The window must not reach the next corner. */
    double nearest = 1e9;
    for (size_t i = 1; i < corners.size(); i++) {
        if (i % (size_t)shape.width != 0) {
            nearest = std::min(nearest, cv::norm(corners[i] - corners[i - 1]));
        }
    }
    int half = std::max(2, std::min(11, (int)(nearest / 3.0)));
    cv::cornerSubPix(image, corners, cv::Size(half, half), cv::Size(-1, -1),
                     cv::TermCriteria(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 60, 1e-3));
    for (size_t i = 0; i < corners.size(); i++) {
        out[i][0] = corners[i].x;
        out[i][1] = corners[i].y;
    }
    return true;
}

std::vector<std::vector<cv::Point3f>> board_points(const problem &p)
{
    std::vector<cv::Point3f> flat;
    for (int row = 0; row < p.rows; row++) {
        for (int column = 0; column < p.columns; column++) {
            flat.emplace_back((float)(p.square_mm * column), (float)(p.square_mm * row), 0.0f);
        }
    }
    return std::vector<std::vector<cv::Point3f>>((size_t)p.n_pairs, flat);
}

std::vector<std::vector<cv::Point2f>> picture_points(const problem &p, int eye)
{
    size_t n = (size_t)p.columns * (size_t)p.rows;
    std::vector<std::vector<cv::Point2f>> all((size_t)p.n_pairs);
    for (size_t i = 0; i < all.size() * n; i++) {
        all[i / n].emplace_back(p.corners_px[eye][i][0], p.corners_px[eye][i][1]);
    }
    return all;
}

iso_board_opencv_camera camera_of(const cv::Mat &m, const cv::Mat &distortion)
{
    cv::Mat d = distortion.reshape(1, 1);
    return {m.at<double>(0, 0), m.at<double>(1, 1), m.at<double>(0, 2), m.at<double>(1, 2),
            d.at<double>(0),    d.at<double>(1),    d.at<double>(2),    d.at<double>(3)};
}

void solve_single(const problem &p, iso_board_opencv_single &out, double (*normals)[3])
{
    cv::setNumThreads(0);
    cv::TermCriteria until(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 60, 1e-9);
    std::vector<cv::Mat> turns, shifts;
    cv::Mat matrix, distortion;
    out.rms_px = cv::calibrateCamera(board_points(p), picture_points(p, 0),
                                     cv::Size(p.width_px, p.height_px), matrix, distortion, turns,
                                     shifts, cv::CALIB_FIX_K3, until);
    out.camera = camera_of(matrix, distortion);
    for (size_t i = 0; i < turns.size(); i++) {
        cv::Mat turn;
        cv::Rodrigues(turns[i], turn);
        for (int k = 0; k < 3; k++) {
            normals[i][k] = turn.at<double>(k, 2);
        }
    }
}

void tell_solved(const problem &p)
{
    if (p.solved) {
        p.solved(p.context);
    }
}

void solve(const problem &p, solution &out)
{
    cv::setNumThreads(0);
    cv::Size size(p.width_px, p.height_px);
    cv::TermCriteria until(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 40, 1e-7);
    auto board = board_points(p);
    std::vector<std::vector<cv::Point2f>> seen[2];
    cv::Mat matrix[2], distortion[2], rotation, translation, essential, fundamental;
    for (int eye = 0; eye < 2; eye++) {
        std::vector<cv::Mat> turns, shifts;
        seen[eye] = picture_points(p, eye);
        cv::calibrateCamera(board, seen[eye], size, matrix[eye], distortion[eye], turns, shifts,
                            cv::CALIB_FIX_K3, until);
        tell_solved(p);
    }
    out.rms_px = cv::stereoCalibrate(board, seen[0], seen[1], matrix[0], distortion[0], matrix[1],
                                     distortion[1], size, rotation, translation, essential,
                                     fundamental, cv::CALIB_USE_INTRINSIC_GUESS | cv::CALIB_FIX_K3,
                                     until);
    tell_solved(p);
    for (int eye = 0; eye < 2; eye++) {
        out.camera[eye] = camera_of(matrix[eye], distortion[eye]);
    }
    std::copy(rotation.begin<double>(), rotation.end<double>(), out.rotation);
    std::copy(translation.begin<double>(), translation.end<double>(), out.translation_mm);
}

} // namespace

int iso_board_opencv_find(const uint8_t *image, int width_px, int height_px, int columns, int rows,
                          float (*corners_px)[2])
{
    bool found = false;
    int error = iso::guarded([&] {
        found = find(iso::wrap(cv::Size(width_px, height_px), CV_8UC1, image),
                     cv::Size(columns, rows), corners_px);
    });
    return error || found ? error : -ENOENT;
}

int iso_board_opencv_solve(const struct iso_board_opencv_problem *problem,
                           struct iso_board_opencv_solution *out)
{
    return iso::guarded([&] {
        solution found;
        solve(*problem, found);
        *out = found;
    });
}

int iso_board_opencv_solve_single(const struct iso_board_opencv_problem *problem,
                                  struct iso_board_opencv_single *out, double (*normals)[3])
{
    return iso::guarded([&] {
        iso_board_opencv_single found;
        solve_single(*problem, found, normals);
        *out = found;
    });
}
