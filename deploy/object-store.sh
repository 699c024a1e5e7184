#!/bin/sh
# Starts SeaweedFS with one S3 user. Its credentials come from the environment and are written to the temporary
# file system: a read-only container cannot take them as an inline Compose config.
set -eu
# the secret becomes part of a JSON document
case ${S3_SECRET:?is not set} in
*[!A-Za-z0-9+/=_.-]*)
	echo "S3_SECRET may contain letters, digits and + / = _ . - only" >&2
	exit 2
	;;
esac
umask 077
cat >"${CREDENTIALS:=/tmp/s3.json}" <<END
{"identities": [{"name": "galewood", "actions": ["Admin", "Read", "Write", "List", "Tagging"],
 "credentials": [{"accessKey": "galewood", "secretKey": "$S3_SECRET"}]}]}
END
# -ip: the name that other services use; an address would change with the container.
# -volume.preStopSeconds: by default a volume server goes on for 10 s after it has left the master, so that clients
# find another one. Here there is none, and Docker kills what has not ended after 10 s unless it is told otherwise.
exec weed -logtostderr=true server -ip=objects -ip.bind=0.0.0.0 -dir=/data -s3 -s3.config="$CREDENTIALS" \
	-volume.max=64 -volume.preStopSeconds=1 -master.volumeSizeLimitMB=1024
