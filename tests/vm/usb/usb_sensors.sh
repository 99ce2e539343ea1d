#!/bin/sh
# Runs the contract suite of the sensor class on USB cameras, by V4L2 and by libcamera.
. "$VM_SOURCE/tests/vm/usb/usb_camera.sh"
insmod "$VM_CACHE/firmware_path.ko"
/lib/systemd/systemd-udevd --daemon # it reports cameras to libcamera
export LIBCAMERA_LOG_LEVELS=*:ERROR
exec "$VM_BUILD/tests/vm/vm_sensor_contract"
