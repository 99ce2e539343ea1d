/* The head model that ships with the product. */
#ifndef TESTS_CORE_SURFACES_SHIPPED_MODEL_H
#define TESTS_CORE_SURFACES_SHIPPED_MODEL_H

#include "isotherm/head_model.h"

/* Free it with iso_head_model_free. A failure fails the running cmocka test. */
struct iso_head_model *shipped_head_model(void);

#endif
