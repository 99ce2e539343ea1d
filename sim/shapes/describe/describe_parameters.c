#include "sim/shapes/describe/describe_parameters.h"

#include <string.h>

#include "sim/lab/report/json.h"

static json_t *describe_array(const struct sim_array *array, enum sim_array_format format)
{
    static const char *const types[] = {"float64", "float32", "int32"};
    char file[SIM_ARRAY_NAME_MAX + 8];
    sim_array_file_name(array, format, file, sizeof file);
    json_t *size = array->columns ? json_pack("[i,i]", array->rows, array->columns)
                                  : json_pack("[i]", array->rows);
    return json_pack("{s:s, s:s, s:s, s:o, s:s}", "name", array->name, "file", file, "type",
                     types[array->type], "shape", size, "meaning", array->meaning);
}

static json_t *describe_file(const struct sim_describe_subject *subject)
{
    const struct sim_source_look *look = &subject->look;
    const struct iso_part_survey *part = &look->part;
    return json_pack("{s:s, s:i, s:i, s:b, s:i, s:i, s:i, s:i, s:i, s:i, s:i, s:i, s:i, s:f, s:f}",
                     "file", subject->path, "points_of_cloud", look->points, "points_left_out",
                     look->points_left_out, "colours", look->colours, "merged_vertices",
                     look->mended.merged, "collapsed_triangles", look->mended.collapsed,
                     "repeated_triangles", look->mended.repeated, "unused_vertices",
                     look->mended.unused, "parts", part->n_parts, "vertices_of_part",
                     part->n_vertices, "triangles_of_part", part->n_triangles, "vertices_left_out",
                     part->vertices_left_out, "flat_triangles", part->flat_triangles,
                     "area_of_part", part->area, "area_left_out", part->area_left_out);
}

static const struct sim_array *find_array(const struct sim_arrays *arrays, const char *name)
{
    for (int i = 0; i < arrays->n; i++) {
        if (strcmp(arrays->array[i].name, name) == 0) {
            return &arrays->array[i];
        }
    }
    return NULL;
}

/* How many steps there are, and the first and the last of them; null if the array was not wanted.
 */
static json_t *describe_steps(const struct sim_arrays *arrays, const char *name)
{
    const struct sim_array *steps = find_array(arrays, name);
    return !steps ? json_null()
                  : json_pack("{s:i, s:f, s:f}", "number", steps->rows, "first",
                              sim_array_item(steps, 0, 0), "last",
                              sim_array_item(steps, steps->rows - 1, 0));
}

static json_t *describe_shape(const struct sim_describe_options *o,
                              const struct sim_describe_subject *subject)
{
    const struct iso_shape *shape = subject->shape;
    return json_pack("{s:i, s:i, s:f, s:i, s:i, s:s, s:s, s:s, s:s, s:o, s:o, s:o, s:i, s:s}",
                     "vertices", shape->mesh->n_vertices, "triangles", shape->mesh->n_triangles,
                     "total_area", shape->total_area, "eigenpairs", shape->pairs->k,
                     "eigenpairs_wanted", o->pairs ? o->pairs : ISO_SHAPE_PAIRS, "laplacian",
                     shape->is_cloud ? "cloud" : o->laplacian, "mass", "consistent finite elements",
                     "boundary", "Neumann", "heat", "dU/dt = -Delta U: decay exp(-lambda t)",
                     "hks_times", describe_steps(subject->arrays, "hks_time"), "wks_energies",
                     describe_steps(subject->arrays, "wks_energy"), "neighbours",
                     shape->is_cloud
                         ? json_integer(o->neighbours ? o->neighbours : ISO_CLOUD_NEIGHBOURS)
                         : json_null(),
                     "heat_source", o->quantity.heat_source, "view_score", o->view_score);
}

int sim_describe_parameters(const struct sim_describe_options *options,
                            enum sim_array_format format,
                            const struct sim_describe_subject *subject, const char *path,
                            struct iso_fault *fault)
{
    json_t *arrays = json_array();
    for (int i = 0; i < subject->arrays->n; i++) {
        (void)json_array_append_new(arrays, describe_array(&subject->arrays->array[i], format));
    }
    json_t *document = json_pack("{s:s, s:s, s:s, s:s, s:i, s:o, s:o, s:o}", "program",
                                 "isotherm-sim shapes describe", "version", ISOTHERM_VERSION,
                                 "what", options->what, "format", options->format, "thinned_to",
                                 options->vertices, "source", describe_file(subject), "shape",
                                 describe_shape(options, subject), "arrays", arrays);
    return sim_json_file(document, path, fault);
}
