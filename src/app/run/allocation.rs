//! Slurm's description of the job in which the program runs.

/// The job, and its resources.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Allocation {
    /// Job, and task if it is one of an array, as Slurm writes it: `12_3`.
    pub job: String,
    /// Number of restarts by Slurm.
    pub restarts: u64,
    /// Processors of a task.
    pub processors: Option<usize>,
    /// Memory (bytes).
    pub memory: Option<u64>,
}

impl Allocation {
    /// The job of this process; `None` outside a job.
    pub fn here() -> Option<Self> {
        Self::of(|name| std::env::var(name).ok())
    }

    fn of(variable: impl Fn(&str) -> Option<String>) -> Option<Self> {
        let number = |name| variable(name)?.trim().parse::<u64>().ok();
        let job = match (variable("SLURM_ARRAY_JOB_ID"), variable("SLURM_ARRAY_TASK_ID")) {
            (Some(array), Some(task)) => format!("{array}_{task}"),
            _ => variable("SLURM_JOB_ID")?,
        };
        let on_node = number("SLURM_CPUS_ON_NODE");
        let processors = number("SLURM_CPUS_PER_TASK").or(on_node).filter(|n| *n > 0);
        // Megabytes of 2^20 bytes; 0 means all memory of the node.
        let per_processor = || number("SLURM_MEM_PER_CPU")?.checked_mul(on_node.or(processors)?);
        let memory = number("SLURM_MEM_PER_NODE").or_else(per_processor).filter(|megabytes| *megabytes > 0);
        Some(Self {
            job,
            restarts: number("SLURM_RESTART_COUNT").unwrap_or(0),
            processors: processors.and_then(|n| usize::try_from(n).ok()),
            memory: memory.and_then(|megabytes| megabytes.checked_mul(1 << 20)),
        })
    }

    /// Worker threads: the number of processors of the job, and no more than this process may run on.
    pub fn threads(&self) -> Option<usize> {
        let here = std::thread::available_parallelism().map_or(usize::MAX, usize::from);
        self.processors.map(|processors| processors.min(here))
    }
}

#[cfg(test)]
mod tests {
    use super::Allocation;

    fn allocation(variables: &[(&str, &str)]) -> Option<Allocation> {
        let find = |name: &str| variables.iter().find(|(key, _)| *key == name);
        Allocation::of(|name| find(name).map(|(_, value)| (*value).to_string()))
    }

    #[test]
    fn what_slurm_says_is_understood() {
        assert_eq!(allocation(&[("HOME", "/root")]), None);
        let task = allocation(&[
            ("SLURM_JOB_ID", "14"),
            ("SLURM_ARRAY_JOB_ID", "12"),
            ("SLURM_ARRAY_TASK_ID", "3"),
            ("SLURM_RESTART_COUNT", "2"),
            ("SLURM_CPUS_PER_TASK", "4"),
            ("SLURM_CPUS_ON_NODE", "8"),
            ("SLURM_MEM_PER_NODE", "600"),
        ]);
        let wanted =
            Allocation { job: "12_3".into(), restarts: 2, processors: Some(4), memory: Some(600 << 20) };
        assert_eq!(task, Some(wanted));
        let by_processor =
            allocation(&[("SLURM_JOB_ID", "14"), ("SLURM_CPUS_ON_NODE", "8"), ("SLURM_MEM_PER_CPU", "100")])
                .unwrap();
        assert_eq!(by_processor.memory, Some(800 << 20));
        assert_eq!((by_processor.processors, by_processor.job.as_str()), (Some(8), "14"));
        let all = allocation(&[("SLURM_JOB_ID", "14"), ("SLURM_MEM_PER_NODE", "0")]).unwrap();
        assert_eq!((all.memory, all.processors), (None, None));
    }
}
