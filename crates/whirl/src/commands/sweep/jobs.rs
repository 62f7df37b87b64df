//! Job files for schedulers that exist.

use std::path::Path;

/// The job array for Slurm.
pub(super) const SLURM: &str = "array.sh";
/// The indexed job for Kubernetes.
pub(super) const KUBERNETES: &str = "job.yaml";

/// A job array: a task a shard, put back in the queue when its node dies.
pub(super) fn slurm(plan: &Path, shards: u64) -> String {
    let (plan, last) = (quoted(plan), shards - 1);
    format!(
        "#!/bin/sh\n#SBATCH --job-name=whirl-sweep\n#SBATCH --array=0-{last}\n#SBATCH --requeue\n#SBATCH --ntasks=1\n#SBATCH --cpus-per-task=1\n\
         # As many threads as the task has been given.\nexport RAYON_NUM_THREADS=\"${{SLURM_CPUS_PER_TASK:-1}}\"\n\
         exec \"${{WHIRL:-whirl}}\" sweep run {plan} --shard \"$SLURM_ARRAY_TASK_ID\"\n"
    )
}

/// An indexed job; the image, and the volume that the plan lies on, are for whoever runs it to name.
pub(super) fn kubernetes(plan: &Path, shards: u64) -> String {
    let plan = quoted(plan);
    format!(
        "apiVersion: batch/v1\nkind: Job\nmetadata:\n  name: whirl-sweep\nspec:\n  completionMode: Indexed\n  completions: {shards}\n  parallelism: {shards}\n  \
         backoffLimitPerIndex: 3\n  template:\n    spec:\n      restartPolicy: Never\n      containers:\n        - name: whirl\n          image: whirl\n          \
         workingDir: /sweep\n          command: [\"sh\", \"-c\"]\n          args:\n            - exec whirl sweep run {plan} --shard \"$JOB_COMPLETION_INDEX\"\n          \
         volumeMounts:\n            - {{ name: sweep, mountPath: /sweep }}\n      volumes:\n        - name: sweep\n          persistentVolumeClaim: {{ claimName: sweep }}\n"
    )
}

/// A path as a word of a shell.
fn quoted(path: &Path) -> String {
    format!("'{}'", path.display().to_string().replace('\'', "'\\''"))
}
