#include "tests/firmware/rigs/puppet_counter.h"

#include <errno.h>

static int refuse(const struct puppet_counter *puppet, struct iso_fault *fault)
{
    const int missing = puppet->defined ? 0 : -ENOENT;
    const int error = puppet->error ? puppet->error : missing;
    return error ? iso_fault_set_code(fault, ISO_FAULT_TPM_FAILED, error, "the puppet: error %d",
                                      -error)
                 : 0;
}

static int read_value(void *self, uint64_t *value, struct iso_fault *fault)
{
    const struct puppet_counter *puppet = self;
    const int error = refuse(puppet, fault);
    if (!error) {
        *value = puppet->value;
    }
    return error;
}

static int increment(void *self, uint64_t *value, struct iso_fault *fault)
{
    struct puppet_counter *puppet = self;
    const int error = refuse(puppet, fault);
    if (!error && puppet->loses_answer) {
        puppet->value++;
        return iso_fault_set_code(fault, ISO_FAULT_TPM_FAILED, -EIO, "the puppet: no answer");
    }
    if (!error) {
        *value = ++puppet->value;
        puppet->increments++;
        if (puppet->incremented) {
            puppet->incremented();
        }
    }
    return error;
}

static int define(void *self, uint64_t *value, struct iso_fault *fault)
{
    struct puppet_counter *puppet = self;
    puppet->defined = puppet->defined || !puppet->error;
    return increment(self, value, fault);
}

static void let_go(void *self)
{
    (void)self;
}

struct iso_counter puppet_counter(struct puppet_counter *puppet)
{
    static const struct iso_counter_ops ops = {
        .name = "puppet",
        .read = read_value,
        .define = define,
        .increment = increment,
        .close = let_go,
    };
    return (struct iso_counter){&ops, puppet};
}
