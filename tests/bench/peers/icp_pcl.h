/* Registration of two sets of points by the Point Cloud Library, for comparison, in C++. */
#ifndef TESTS_BENCH_PEERS_ICP_PCL_H
#define TESTS_BENCH_PEERS_ICP_PCL_H

#ifdef __cplusplus
extern "C" {
#endif

/* Runs pcl::IterativeClosestPoint with its defaults except for the limits. `matrix` receives
 * target_from_source, 4 x 4, row by row. 0, or -ENOTRECOVERABLE if it did not converge. */
int peer_pcl_icp(const float (*source_mm)[3], const float (*target_mm)[3], int n, int iterations,
                 double tolerance, double matrix[16]);

#ifdef __cplusplus
}
#endif

#endif
