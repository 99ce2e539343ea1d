/* Allocations fail at every point between a mesh and its class. The result is -ENOMEM, and nothing
 * leaks (the sanitised build checks this). The test compiles the sources under test into itself, so
 * that the linker's --wrap affects them. */
#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "core/shape/classify/confusion.h"
#include "core/shape/classify/retrieval.h"
#include "isotherm/classifier.h"
#include "isotherm/signature.h"
#include "tests/core/surfaces/shapes.h"
#include "tests/support/memory/scarce_memory.h"

enum { SHAPES = 3, CLASSES = 2 };

struct corpus {
    struct iso_mesh *mesh;
    struct iso_colour colour[200];
    const struct iso_shape_method *method;
    struct iso_shape *shape;
    const struct iso_shape_description *description[SHAPES];
    struct iso_labelled labelled;
    const struct iso_classifier_ops *ops;
};

/* Every failure must be -ENOMEM. */
static int said(int error, struct iso_fault *fault)
{
    return error == -ENOMEM ? iso_fault_set(fault, error, "out of memory") : error;
}

static int prepare(void *context, struct iso_fault *fault)
{
    struct corpus *c = context;
    struct iso_shape *shape = NULL;
    int error = iso_shape_new(c->mesh, c->colour, 12, &shape);
    assert_true(!error == !!shape);
    iso_shape_free(shape);
    return said(error, fault);
}

static int prepare_robust(void *context, struct iso_fault *fault)
{
    struct corpus *c = context;
    struct iso_shape *shape = NULL;
    int error = iso_shape_new_robust(c->mesh, c->colour, 12, &shape);
    assert_true(!error == !!shape);
    iso_shape_free(shape);
    return said(error, fault);
}

static int prepare_cloud(void *context, struct iso_fault *fault)
{
    struct corpus *c = context;
    struct iso_shape *shape = NULL;
    int error = iso_shape_new_cloud(c->mesh->vertices_mm, c->colour, c->mesh->n_vertices, 0, 12,
                                    &shape);
    assert_true(!error == !!shape);
    iso_shape_free(shape);
    return said(error, fault);
}

static int look(void *context, struct iso_fault *fault)
{
    struct corpus *c = context;
    struct iso_shape_view view[2];
    int n = 0;
    int error = iso_shape_views(c->mesh, ISO_VIEW_ENTROPY, 0.5, 2, view, &n);
    assert_int_equal(n, error ? 0 : 2);
    return said(error, fault);
}

static int describe(void *context, struct iso_fault *fault)
{
    struct corpus *c = context;
    struct iso_shape_description *made = NULL;
    int error = iso_shape_describe(c->method, c->shape, &made);
    assert_true(!error == !!made);
    iso_shape_description_free(made);
    return said(error, fault);
}

static int code(void *context, struct iso_fault *fault)
{
    struct corpus *c = context;
    struct iso_shape_coder *coder = NULL;
    int error = iso_shape_coder_new(c->method, c->description, SHAPES, 2, 1, &coder);
    assert_true(!error == !!coder);
    iso_shape_coder_free(coder);
    return said(error, fault);
}

static int classify(void *context, struct iso_fault *fault)
{
    struct corpus *c = context;
    double score[SHAPES * CLASSES], distance[SHAPES];
    struct iso_classifier *classifier = NULL;
    int error = iso_classifier_new(c->ops, &c->labelled, &classifier);
    if (!error) {
        error = iso_classifier_score(classifier, c->labelled.feature, score);
    }
    if (!error && c->ops->rank) {
        error = iso_classifier_rank(classifier, c->labelled.feature, 0, distance);
    }
    iso_classifier_free(classifier);
    if (!error) {
        error = iso_cross_validate(c->ops, &c->labelled, SHAPES, 1, score);
    }
    return said(error, fault);
}

static int measure(void *context, struct iso_fault *fault)
{
    struct corpus *c = context;
    const double distance[SHAPES * SHAPES] = {0, 1, 2, 1, 0, 2, 2, 1, 0};
    const int32_t *label = c->labelled.label;
    const struct iso_ranked ranked = {SHAPES, SHAPES, distance, label, label, NULL, NULL, NULL};
    struct iso_retrieval retrieval;
    struct iso_confusion_rates mean;
    int error = iso_retrieval_measure(&ranked, &retrieval);
    if (!error) {
        error = iso_confusion_measure(distance, label, SHAPES, SHAPES, NULL, NULL, &mean);
    }
    return said(error, fault);
}

static void nothing_leaks_when_memory_runs_out(void **state)
{
    (void)state;
    static struct corpus c;
    c.mesh = shape_sphere(1, 4.0);
    for (int32_t v = 0; v < c.mesh->n_vertices; v++) {
        c.mesh->vertices_mm[v].z *= 1.5;
        c.colour[v] = (struct iso_colour){{0.3f, 0.6f, 0.9f}};
    }
    print_message("shape: %d allocations\n", scarce_memory_exhaust(prepare, &c, 400));
    print_message("robust: %d allocations\n", scarce_memory_exhaust(prepare_robust, &c, 600));
    print_message("cloud: %d allocations\n", scarce_memory_exhaust(prepare_cloud, &c, 800));
    print_message("views: %d allocations\n", scarce_memory_exhaust(look, &c, 20));
    assert_int_equal(iso_shape_new(c.mesh, c.colour, 12, &c.shape), 0);
    for (const struct iso_shape_method *const *m = iso_shape_methods; *m; m++) {
        struct iso_shape_description *made = NULL;
        c.method = *m;
        int described = scarce_memory_exhaust(describe, &c, 100);
        assert_int_equal(iso_shape_describe(c.method, c.shape, &made), 0);
        for (int i = 0; i < SHAPES; i++) {
            c.description[i] = made;
        }
        print_message("%s: %d, coder %d\n", c.method->name, described,
                      scarce_memory_exhaust(code, &c, 100));
        iso_shape_description_free(made);
    }
    const struct iso_feature_layout layout = {4, 2, {3, 1}, ISO_NORM_L1};
    const float feature[SHAPES][4] = {{1, 2, 3, 4}, {2, 1, 3, 5}, {-1, 0, 4, 1}};
    const int32_t label[SHAPES] = {0, 0, 1};
    c.labelled = (struct iso_labelled){&layout, SHAPES, CLASSES, feature[0], label};
    for (const struct iso_classifier_ops *const *ops = iso_classifiers; *ops; ops++) {
        c.ops = *ops;
        print_message("%s: %d\n", c.ops->name, scarce_memory_exhaust(classify, &c, 200));
    }
    assert_true(scarce_memory_exhaust(measure, &c, 50) > 0);
    iso_shape_free(c.shape);
    iso_mesh_free(c.mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nothing_leaks_when_memory_runs_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
