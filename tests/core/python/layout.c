/* Prints where the compiler puts each member of the structs that the Python module mirrors
 * (core/python/isotherm/_structs.py): "struct member offset size", and "struct - 0 size" for the
 * struct itself. A member whose name is a word of Python has an underscore at its end there. */
#include <isotherm/isotherm.h>

#include <stddef.h>
#include <stdio.h>

#define WHOLE(type) printf(#type " - 0 %zu\n", sizeof(struct type))
#define MEMBER(type, member)                                              \
    printf(#type " " #member " %zu %zu\n", offsetof(struct type, member), \
           sizeof(((struct type *)0)->member))

static void print_meshes(void)
{
    WHOLE(iso_fault);
    MEMBER(iso_fault, text);
    MEMBER(iso_fault, code);
    WHOLE(iso_mesh);
    MEMBER(iso_mesh, n_vertices);
    MEMBER(iso_mesh, n_triangles);
    MEMBER(iso_mesh, vertex_capacity);
    MEMBER(iso_mesh, triangle_capacity);
    MEMBER(iso_mesh, vertices_mm);
    MEMBER(iso_mesh, triangles);
    WHOLE(iso_coloured_mesh);
    MEMBER(iso_coloured_mesh, mesh);
    MEMBER(iso_coloured_mesh, colour);
    WHOLE(iso_mesh_mended);
    MEMBER(iso_mesh_mended, merged);
    MEMBER(iso_mesh_mended, collapsed);
    MEMBER(iso_mesh_mended, repeated);
    MEMBER(iso_mesh_mended, unused);
}

static void print_frames(void)
{
    WHOLE(iso_camera);
    MEMBER(iso_camera, projection);
    MEMBER(iso_camera, width_px);
    MEMBER(iso_camera, height_px);
    MEMBER(iso_camera, fx_px);
    MEMBER(iso_camera, fy_px);
    MEMBER(iso_camera, pitch_mm);
    MEMBER(iso_camera, cx_px);
    MEMBER(iso_camera, cy_px);
    MEMBER(iso_camera, k1);
    MEMBER(iso_camera, k2);
    MEMBER(iso_camera, k3);
    MEMBER(iso_camera, p1);
    MEMBER(iso_camera, p2);
    WHOLE(iso_frame);
    MEMBER(iso_frame, camera);
    MEMBER(iso_frame, width_px);
    MEMBER(iso_frame, height_px);
    MEMBER(iso_frame, crop_x_px);
    MEMBER(iso_frame, crop_y_px);
    MEMBER(iso_frame, t_ns);
    MEMBER(iso_frame, sequence);
    MEMBER(iso_frame, depth_mm);
    MEMBER(iso_frame, intensity);
    WHOLE(iso_triangulate_options);
    MEMBER(iso_triangulate_options, jump_mm);
    MEMBER(iso_triangulate_options, largest_only);
}

static void print_spectra(void)
{
    WHOLE(iso_symmetric);
    MEMBER(iso_symmetric, n);
    MEMBER(iso_symmetric, nnz);
    MEMBER(iso_symmetric, n_capacity);
    MEMBER(iso_symmetric, nnz_capacity);
    MEMBER(iso_symmetric, column_start);
    MEMBER(iso_symmetric, row);
    MEMBER(iso_symmetric, value);
    WHOLE(iso_eigenpairs);
    MEMBER(iso_eigenpairs, n);
    MEMBER(iso_eigenpairs, k);
    MEMBER(iso_eigenpairs, lambda);
    MEMBER(iso_eigenpairs, phi);
    WHOLE(iso_critical_points);
    MEMBER(iso_critical_points, n);
    MEMBER(iso_critical_points, vertex);
    WHOLE(iso_shared_functions);
    MEMBER(iso_shared_functions, n);
    MEMBER(iso_shared_functions, from);
    MEMBER(iso_shared_functions, to);
    WHOLE(iso_surface_point);
    MEMBER(iso_surface_point, triangle);
    MEMBER(iso_surface_point, weight);
    WHOLE(iso_heat_direct_options);
    MEMBER(iso_heat_direct_options, n_capacity);
    MEMBER(iso_heat_direct_options, nnz_capacity);
    MEMBER(iso_heat_direct_options, krylov);
    MEMBER(iso_heat_direct_options, gamma_over_t);
    WHOLE(iso_match_options);
    MEMBER(iso_match_options, first_pairs);
    MEMBER(iso_match_options, step);
    MEMBER(iso_match_options, weight);
}

static void print_shape(void)
{
    WHOLE(iso_shape);
    MEMBER(iso_shape, mesh);
    MEMBER(iso_shape, colour);
    MEMBER(iso_shape, area);
    MEMBER(iso_shape, total_area);
    MEMBER(iso_shape, near_boundary);
    MEMBER(iso_shape, neighbour_start);
    MEMBER(iso_shape, neighbour);
    MEMBER(iso_shape, stiffness);
    MEMBER(iso_shape, mass);
    MEMBER(iso_shape, pairs);
    MEMBER(iso_shape, weighted);
    MEMBER(iso_shape, is_cloud);
    WHOLE(iso_shape_view);
    MEMBER(iso_shape_view, direction);
    MEMBER(iso_shape_view, entropy);
    MEMBER(iso_shape_view, divergence);
}

static void print_rigid_motions(void)
{
    WHOLE(iso_vec3);
    MEMBER(iso_vec3, x);
    MEMBER(iso_vec3, y);
    MEMBER(iso_vec3, z);
    WHOLE(iso_mat3);
    MEMBER(iso_mat3, m);
    WHOLE(iso_rigid);
    MEMBER(iso_rigid, rotation);
    MEMBER(iso_rigid, translation_mm);
}

static void print_heads(void)
{
    WHOLE(iso_head_point);
    MEMBER(iso_head_point, triangle);
    MEMBER(iso_head_point, weight);
    WHOLE(iso_head_model);
    MEMBER(iso_head_model, n_vertices);
    MEMBER(iso_head_model, n_triangles);
    MEMBER(iso_head_model, n_identity);
    MEMBER(iso_head_model, n_expression);
    MEMBER(iso_head_model, crc32);
    MEMBER(iso_head_model, mean_mm);
    MEMBER(iso_head_model, triangles);
    MEMBER(iso_head_model, region);
    MEMBER(iso_head_model, identity_mm);
    MEMBER(iso_head_model, expression_mm);
    MEMBER(iso_head_model, landmarks);
    WHOLE(iso_shape_fit_options);
    MEMBER(iso_shape_fit_options, rigid_iterations);
    MEMBER(iso_shape_fit_options, iterations);
    MEMBER(iso_shape_fit_options, jaws);
    MEMBER(iso_shape_fit_options, vertices);
    MEMBER(iso_shape_fit_options, cutoff_first_mm);
    MEMBER(iso_shape_fit_options, cutoff_last_mm);
    MEMBER(iso_shape_fit_options, soft_weight);
    MEMBER(iso_shape_fit_options, identity_stiffness_mm2);
    MEMBER(iso_shape_fit_options, expression_stiffness_mm2);
    WHOLE(iso_occlusion);
    MEMBER(iso_occlusion, covered);
    MEMBER(iso_occlusion, rest_mm2);
}

static void print_extract_options(void)
{
    WHOLE(iso_extract_options);
    MEMBER(iso_extract_options, t_mm2);
    MEMBER(iso_extract_options, n_radii);
    MEMBER(iso_extract_options, radius_mm);
    MEMBER(iso_extract_options, n_points);
    MEMBER(iso_extract_options, crop_radius_mm);
    MEMBER(iso_extract_options, spacing_mm);
    MEMBER(iso_extract_options, smoothing_mm);
    MEMBER(iso_extract_options, outlier_mm);
    MEMBER(iso_extract_options, fit);
    MEMBER(iso_extract_options, distance_min_mm);
    MEMBER(iso_extract_options, distance_max_mm);
    MEMBER(iso_extract_options, yaw_max_rad);
    MEMBER(iso_extract_options, pitch_max_rad);
    MEMBER(iso_extract_options, track);
    MEMBER(iso_extract_options, heat);
    MEMBER(iso_extract_options, sensor);
    MEMBER(iso_extract_options, now_ns);
    MEMBER(iso_extract_options, now_context);
}

static void print_templates(void)
{
    WHOLE(iso_upper_face);
    MEMBER(iso_upper_face, z_mm);
    MEMBER(iso_upper_face, kind);
    WHOLE(iso_template);
    MEMBER(iso_template, algorithm);
    MEMBER(iso_template, sensor);
    MEMBER(iso_template, n_radii);
    MEMBER(iso_template, n_points);
    MEMBER(iso_template, n_frames);
    MEMBER(iso_template, learned);
    MEMBER(iso_template, quality);
    MEMBER(iso_template, radius_mm);
    MEMBER(iso_template, points_mm);
    MEMBER(iso_template, weight);
    MEMBER(iso_template, upper);
}

static void print_extraction(void)
{
    WHOLE(iso_extraction);
    MEMBER(iso_extraction, outcome);
    MEMBER(iso_extraction, cue);
    MEMBER(iso_extraction, camera_from_face);
    MEMBER(iso_extraction, yaw_rad);
    MEMBER(iso_extraction, pitch_rad);
    MEMBER(iso_extraction, roll_rad);
    MEMBER(iso_extraction, distance_mm);
    MEMBER(iso_extraction, residual_mm);
    MEMBER(iso_extraction, fitted);
    MEMBER(iso_extraction, tracked);
    MEMBER(iso_extraction, landmark_mm);
    MEMBER(iso_extraction, ibug_mm);
    MEMBER(iso_extraction, sigma_mm);
    MEMBER(iso_extraction, occlusion);
    MEMBER(iso_extraction, fit_coverage);
    MEMBER(iso_extraction, identity_norm);
    MEMBER(iso_extraction, expression_norm);
    MEMBER(iso_extraction, coverage);
    MEMBER(iso_extraction, source_mm);
    MEMBER(iso_extraction, tmpl);
    MEMBER(iso_extraction, stage_ns);
}

static void print_metric(void)
{
    WHOLE(iso_rerank_weights);
    MEMBER(iso_rerank_weights, metric);
    MEMBER(iso_rerank_weights, upper);
    MEMBER(iso_rerank_weights, bias);
    WHOLE(iso_metric);
    MEMBER(iso_metric, algorithm);
    MEMBER(iso_metric, landmarks);
    MEMBER(iso_metric, n_radii);
    MEMBER(iso_metric, n_points);
    MEMBER(iso_metric, n_dimensions);
    MEMBER(iso_metric, weight_min);
    MEMBER(iso_metric, gain);
    MEMBER(iso_metric, bias);
    MEMBER(iso_metric, rerank);
    MEMBER(iso_metric, n_origins);
    MEMBER(iso_metric, origin);
    MEMBER(iso_metric, n_nodes);
    MEMBER(iso_metric, node);
    MEMBER(iso_metric, n_curve_values);
    MEMBER(iso_metric, n_values);
    MEMBER(iso_metric, curve_mm);
    MEMBER(iso_metric, upper_mm);
    MEMBER(iso_metric, between);
    MEMBER(iso_metric, centre);
    MEMBER(iso_metric, axis);
    WHOLE(iso_metric_vector);
    MEMBER(iso_metric_vector, n);
    MEMBER(iso_metric_vector, weight);
    MEMBER(iso_metric_vector, step);
    MEMBER(iso_metric_vector, scale);
    MEMBER(iso_metric_vector, mean);
}

static void print_methods(void)
{
    WHOLE(iso_shape_description);
    MEMBER(iso_shape_description, n_bags);
    MEMBER(iso_shape_description, n_points);
    MEMBER(iso_shape_description, n_values);
    MEMBER(iso_shape_description, local);
    MEMBER(iso_shape_description, weight);
    MEMBER(iso_shape_description, n_parts);
    MEMBER(iso_shape_description, part_size);
    MEMBER(iso_shape_description, whole);
    WHOLE(iso_describe_times);
    MEMBER(iso_describe_times, n);
    MEMBER(iso_describe_times, first);
    MEMBER(iso_describe_times, last);
    WHOLE(iso_shape_method);
    MEMBER(iso_shape_method, name);
    MEMBER(iso_shape_method, title);
    MEMBER(iso_shape_method, source);
    MEMBER(iso_shape_method, colour);
    MEMBER(iso_shape_method, coding);
    MEMBER(iso_shape_method, size);
    MEMBER(iso_shape_method, norm);
    MEMBER(iso_shape_method, classifier);
    MEMBER(iso_shape_method, kept_parts);
    MEMBER(iso_shape_method, times);
    MEMBER(iso_shape_method, describe);
}

static void print_classifiers(void)
{
    WHOLE(iso_feature_layout);
    MEMBER(iso_feature_layout, size);
    MEMBER(iso_feature_layout, n_parts);
    MEMBER(iso_feature_layout, part_size);
    MEMBER(iso_feature_layout, norm);
    WHOLE(iso_labelled);
    MEMBER(iso_labelled, layout);
    MEMBER(iso_labelled, n);
    MEMBER(iso_labelled, n_classes);
    MEMBER(iso_labelled, feature);
    MEMBER(iso_labelled, label);
    WHOLE(iso_classifier_ops);
    MEMBER(iso_classifier_ops, name);
    MEMBER(iso_classifier_ops, title);
    MEMBER(iso_classifier_ops, source);
    MEMBER(iso_classifier_ops, train);
    MEMBER(iso_classifier_ops, free);
    MEMBER(iso_classifier_ops, score);
    MEMBER(iso_classifier_ops, rank);
}

int main(void)
{
    print_meshes();
    print_frames();
    print_spectra();
    print_shape();
    print_rigid_motions();
    print_heads();
    print_extract_options();
    print_templates();
    print_extraction();
    print_metric();
    print_methods();
    print_classifiers();
    return 0;
}
