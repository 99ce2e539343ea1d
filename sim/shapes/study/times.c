#include "sim/shapes/study/times.h"

#include <errno.h>
#include <stdbool.h>

int sim_times_check(const struct iso_shape_method *method, const struct iso_describe_times *chosen,
                    struct iso_fault *fault)
{
    const struct iso_describe_times *own = &method->times;
    struct iso_describe_times times;
    return iso_shape_method_times(method, chosen, &times) == 0
               ? 0
               : iso_fault_set(
                     fault, -EINVAL,
                     "--times, --time-first, --time-last: %s cannot have %d times from %g to %g "
                     "areas; %d to %d times are allowed, the first above 0, the last above the "
                     "first",
                     method->name, chosen->n ? chosen->n : own->n,
                     chosen->first != 0.0 ? chosen->first : own->first,
                     chosen->last != 0.0 ? chosen->last : own->last, (int)ISO_DESCRIBE_TIMES_MIN,
                     (int)ISO_DESCRIBE_TIMES_MAX);
}

int sim_times_check_own(const struct iso_shape_method *method,
                        const struct iso_describe_times *chosen, struct iso_fault *fault)
{
    const bool any = chosen->n != 0 || chosen->first != 0.0 || chosen->last != 0.0;
    return any && method->times.n == 0
               ? iso_fault_set(fault, -EINVAL,
                               "--times, --time-first, --time-last: the times of %s cannot be "
                               "chosen",
                               method->name)
               : sim_times_check(method, chosen, fault);
}

json_t *sim_times_json(const struct iso_shape_method *method,
                       const struct iso_describe_times *chosen)
{
    struct iso_describe_times times;
    return iso_shape_method_times(method, chosen, &times) || times.n == 0
               ? json_null()
               : json_pack("{s:i, s:f, s:f}", "number", times.n, "first", times.first, "last",
                           times.last);
}

int sim_times_read(const struct iso_shape_method *method, json_t *json,
                   struct iso_describe_times *out)
{
    struct iso_describe_times times = {0, 0.0, 0.0}, used;
    json_int_t n = 0;
    if (method->times.n == 0) {
        *out = times;
        return json_is_null(json) ? 0 : -EBADMSG;
    }
    if (json_unpack(json, "{s:I, s:F, s:F}", "number", &n, "first", &times.first, "last",
                    &times.last) != 0 ||
        n < ISO_DESCRIBE_TIMES_MIN || n > ISO_DESCRIBE_TIMES_MAX) {
        return -EBADMSG;
    }
    times.n = (int)n;
    if (iso_shape_method_times(method, &times, &used)) {
        return -EBADMSG;
    }
    *out = times;
    return 0;
}
