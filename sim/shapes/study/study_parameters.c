/* What the figures of a study depend on: the times of the methods, and parameters.json. */
#include <errno.h>

#include "drivers/base/path.h"
#include "sim/lab/report/json.h"
#include "sim/shapes/study/study_data.h"
#include "sim/shapes/study/times.h"

int sim_study_check_times(const struct sim_study *study, struct iso_fault *fault)
{
    int error = 0;
    for (int m = 0; m < study->choice.n_methods && !error; m++) {
        error = sim_times_check(study->choice.method[m], &study->options->times, fault);
    }
    return error;
}

static json_t *methods_json(const struct sim_study *study)
{
    json_t *methods = json_array();
    for (int m = 0; m < study->choice.n_methods; m++) {
        const struct iso_shape_method *method = study->choice.method[m];
        const int words = study->options->words ? study->options->words : method->size;
        (void)json_array_append_new(
            methods, json_pack("{s:s, s:o, s:o}", "name", method->name, "times_in_areas",
                               sim_times_json(method, &study->options->times), "words",
                               method->size > 0 ? json_integer(words) : json_null()));
    }
    return methods;
}

static json_t *classifiers_json(const struct sim_study *study)
{
    json_t *classifiers = json_array();
    for (int c = 0; c < study->choice.n_classifiers; c++) {
        (void)json_array_append_new(classifiers, json_string(study->choice.classifier[c]->name));
    }
    return classifiers;
}

int sim_study_save_parameters(const struct sim_study *study, struct iso_fault *fault)
{
    const struct sim_shapes_study_options *o = study->options;
    char path[PATH_MAX];
    const int error = iso_path_join(o->out, "parameters.json", path, fault);
    if (error) {
        return error;
    }
    json_t *distortion = o->distortion.level > 0
                             ? json_pack("{s:s, s:i}", "kind",
                                         sim_distortion_name(o->distortion.kind), "level",
                                         o->distortion.level)
                             : json_null();
    return sim_json_file(
        json_pack("{s:s, s:s, s:s, s:o, s:o, s:i, s:i, s:i, s:i, s:b, s:o, s:I, s:I}", "program",
                  "isotherm-sim shapes eval", "version", ISOTHERM_VERSION, "corpus", o->corpus,
                  "methods", methods_json(study), "classifiers", classifiers_json(study),
                  "eigenpairs", o->pairs ? o->pairs : ISO_SHAPE_PAIRS, "neighbours_in_clouds",
                  o->neighbours ? o->neighbours : ISO_CLOUD_NEIGHBOURS, "thinned_to", o->vertices,
                  "smooth", o->smooth, "mend", o->mend, "distortion", distortion, "queries",
                  (json_int_t)o->queries, "seed", (json_int_t)o->seed),
        path, fault);
}
