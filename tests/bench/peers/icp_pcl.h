/* Registration of two sets of points as a user of the Point Cloud Library would do it: a peer of
 * the benchmark, in C++. */
#ifndef TESTS_BENCH_PEERS_ICP_PCL_H
#define TESTS_BENCH_PEERS_ICP_PCL_H

#ifdef __cplusplus
extern "C" {
#endif

/* pcl::IterativeClosestPoint with its defaults but for the limits: target_from_source as a
 * row-major 4 x 4 matrix. 0, or -ENOTRECOVERABLE if it did not converge. */
int peer_pcl_icp(const float (*source_mm)[3], const float (*target_mm)[3], int n, int iterations,
                 double tolerance, double matrix[16]);

#ifdef __cplusplus
}
#endif

#endif
