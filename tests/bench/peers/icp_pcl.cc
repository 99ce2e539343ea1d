#include "tests/bench/peers/icp_pcl.h"

#include <cerrno>

#include <pcl/point_types.h>
#include <pcl/registration/icp.h>

using Cloud = pcl::PointCloud<pcl::PointXYZ>;

static Cloud::Ptr cloud_of(const float (*point)[3], int n)
{
    Cloud::Ptr cloud(new Cloud);
    for (int i = 0; i < n; i++) {
        cloud->push_back(pcl::PointXYZ(point[i][0], point[i][1], point[i][2]));
    }
    return cloud;
}

int peer_pcl_icp(const float (*source_mm)[3], const float (*target_mm)[3], int n, int iterations,
                 double tolerance, double matrix[16])
{
    pcl::IterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ> icp;
    Cloud moved;
    icp.setInputSource(cloud_of(source_mm, n));
    icp.setInputTarget(cloud_of(target_mm, n));
    icp.setMaximumIterations(iterations);
    icp.setTransformationEpsilon(tolerance);
    icp.setEuclideanFitnessEpsilon(tolerance);
    icp.align(moved);
    const Eigen::Matrix4f found = icp.getFinalTransformation();
    for (int r = 0; r < 4; r++) {
        for (int c = 0; c < 4; c++) {
            matrix[4 * r + c] = static_cast<double>(found(r, c));
        }
    }
    return icp.hasConverged() ? 0 : -ENOTRECOVERABLE;
}
