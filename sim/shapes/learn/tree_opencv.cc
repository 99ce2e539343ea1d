extern "C" {
#include "sim/shapes/learn/tree.h"
}

#include <cerrno>
#include <cmath>
#include <new>

#include <opencv2/ml.hpp>

/* As deep as a few dozen classes need; a leaf may be a single shape. OpenCV's pruning by
 * cross-validation is off: it fails on classes of few members. */
static const int depth_max = 12;
static const int split_min = 2;

struct iso_tree {
    cv::Ptr<cv::ml::DTrees> model;
    int size;
};

/* OpenCV has no matrix of constant values; it only reads these. */
static cv::Mat rows_of(const float *feature, int rows, int size)
{
    return cv::Mat(rows, size, CV_32F, const_cast<float *>(feature));
}

static void learn(struct iso_tree *tree, const float *feature, const int32_t *label, int n)
{
    const cv::Mat labels(n, 1, CV_32S, const_cast<int32_t *>(label));
    tree->model = cv::ml::DTrees::create();
    tree->model->setMaxDepth(depth_max);
    tree->model->setMinSampleCount(split_min);
    tree->model->setCVFolds(0);
    tree->model->setUseSurrogates(false);
    tree->model->train(rows_of(feature, n, tree->size), cv::ml::ROW_SAMPLE, labels);
}

int iso_tree_new(const float *feature, const int32_t *label, int32_t n, int32_t size,
                 struct iso_tree **out)
{
    struct iso_tree *tree = new (std::nothrow) iso_tree;
    if (!tree) {
        return -ENOMEM;
    }
    tree->size = size;
    int error = 0;
    try {
        learn(tree, feature, label, n);
        error = tree->model->isTrained() ? 0 : -EINVAL;
    } catch (const std::bad_alloc &) {
        error = -ENOMEM;
    } catch (const std::exception &) {
        error = -EINVAL;
    }
    if (error) {
        delete tree;
        return error;
    }
    *out = tree;
    return 0;
}

void iso_tree_free(struct iso_tree *tree)
{
    delete tree;
}

int iso_tree_tell(const struct iso_tree *tree, const float *feature, int32_t *label)
{
    try {
        *label = (int32_t)std::lround(tree->model->predict(rows_of(feature, 1, tree->size)));
        return 0;
    } catch (const std::bad_alloc &) {
        return -ENOMEM;
    } catch (const std::exception &) {
        return -EDOM;
    }
}
