#!/bin/sh
# Tests v4l2-stereo with two cameras of the kernel's test driver, which have only nodes of capture.
set -eu
modprobe -d "$VM_CACHE/root" vivid n_devs=2 node_types=0x1,0x1 num_inputs=1,1 input_types=0,0 no_error_inj=0
for node in /dev/video0 /dev/video1; do
    [ -c "$node" ] || {
        echo "vivid makes no $node"
        exit 1
    }
done
exec "$VM_BUILD/tests/vm/vm_v4l2_vivid"
