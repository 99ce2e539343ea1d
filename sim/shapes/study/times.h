/* The times of heat that a user has chosen: refused in one sentence, and as JSON. */
#ifndef SIM_SHAPES_STUDY_TIMES_H
#define SIM_SHAPES_STUDY_TIMES_H

#include <jansson.h>

#include "core/base/fault.h"
#include "isotherm/shape_method.h"

/* Refuses times that a method cannot have. A method without times that can be chosen accepts any,
 * since it does not use them. -EINVAL with a fault. */
int sim_times_check(const struct iso_shape_method *method, const struct iso_describe_times *chosen,
                    struct iso_fault *fault) __attribute__((warn_unused_result));

/* As sim_times_check(), for a command that has no other method: if any time is chosen, a method
 * without times that can be chosen is refused as well. */
int sim_times_check_own(const struct iso_shape_method *method,
                        const struct iso_describe_times *chosen, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* The times of a method, in areas of the shape, as an object of `number`, `first` and `last`; null
 * for a method without times that can be chosen, and for times that the method cannot have. A new
 * reference; NULL without memory. */
json_t *sim_times_json(const struct iso_shape_method *method,
                       const struct iso_describe_times *chosen);

/* Reads what sim_times_json() has made. -EBADMSG, also for times that the method cannot have, and
 * for null if the method has times. */
int sim_times_read(const struct iso_shape_method *method, json_t *json,
                   struct iso_describe_times *out) __attribute__((warn_unused_result));

#endif
